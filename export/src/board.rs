//! The program that counts the cost of a step on a Cortex-M, real or emulated: programs and command lines; nothing is run here.

use crate::host::CODE_FOLDER;
use crate::{File, Numbers};

/// A processor core, QEMU's board for it, and what the cross compiler must know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TargetCore {
    /// Name for a reader.
    pub name: &'static str,
    /// QEMU's machine.
    pub machine: &'static str,
    /// Flags of the compiler.
    pub flags: [&'static str; 4],
}

/// The cores that costs are counted on.
pub const CORES: [TargetCore; 2] = [
    TargetCore {
        name: "Cortex-M4F",
        machine: "mps2-an386",
        flags: ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"],
    },
    TargetCore {
        name: "Cortex-M7",
        machine: "mps2-an500",
        flags: ["-mcpu=cortex-m7", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv5-d16"],
    },
];

/// The cross compiler.
pub const COMPILER: &str = "arm-none-eabi-gcc";
/// Tells the sizes of an object file.
pub const SIZER: &str = "arm-none-eabi-size";
/// The emulator.
pub const EMULATOR: &str = "qemu-system-arm";
/// Flags with which the generated code is compiled for the target.
pub const COMPILE: [&str; 9] = [
    "-std=c99",
    "-O2",
    "-ffp-contract=off",
    "-Wall",
    "-Wextra",
    "-fstack-usage",
    "-iquote",
    CODE_FOLDER,
    "-c",
];
/// Flags with which a bare-metal program is linked, up to the linker script.
pub const LINK: [&str; 8] = [
    "-std=gnu99",
    "-O2",
    "-ffp-contract=off",
    "-nostartfiles",
    "--specs=rdimon.specs",
    "-Tmps2.ld",
    "-iquote",
    CODE_FOLDER,
];

/// Returns the arguments of [`EMULATOR`] for a core, up to the firmware's path.
pub fn emulator_command(core: &TargetCore) -> [&'static str; 13] {
    [
        "-M",
        core.machine,
        "-nographic",
        "-monitor",
        "none",
        "-serial",
        "none",
        "-semihosting-config",
        "enable=on,target=native",
        "-icount",
        "shift=0",
        "-kernel",
        "firmware.elf",
    ]
}

/// Returns the program that counts for the code of a name: `startup.c`, `mps2.ld` and `count.c`.
pub fn counting_code(name: &str, numbers: Numbers) -> Vec<File> {
    let fixed = if numbers == Numbers::Fixed { "#define AXIS_FIXED\n" } else { "" };
    let count = format!("{fixed}{}", include_str!("../target/count.c"));
    let named = count.replace("axis", name);
    let file = |name: &str, text: &str| File { name: name.to_owned(), text: text.to_owned() };
    vec![
        file("startup.c", include_str!("../target/startup.c")),
        file("mps2.ld", include_str!("../target/mps2.ld")),
        file("count.c", &named),
    ]
}

/// Cost of the code on a core: instructions, cycles and memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CodeCost {
    /// Most instructions of a step over the counter's patterns of readings: rest, both signs, alternating, limiter.
    pub step_instructions: u64,
    /// Most instructions of setting the out-of-balance.
    pub set_instructions: u64,
    /// Code and constants of the controller, bytes; without the self test and the compiler's library.
    pub flash_bytes: u64,
    /// The state that the caller owns, bytes.
    pub state_bytes: u64,
    /// Deepest stack of a function of the controller, bytes; without the compiler's library.
    pub stack_bytes: u64,
}

impl CodeCost {
    /// Reads what the counter printed, what [`SIZER`] said of the controller's object file, and the compiler's stack
    /// usage file. Nothing if one of them is not as expected, or if the self test failed on the target.
    pub fn read(counted: &str, sizes: &str, stack_usage: &str) -> Option<Self> {
        let words: Vec<&str> = counted.split_whitespace().collect();
        let ["wrong", "0", "step", step, "set", set, "state", state] = words.as_slice() else { return None };
        let text = sizes.lines().nth(1)?.split_whitespace().next()?;
        let depths = stack_usage.lines().map(|line| line.split('\t').nth(1)?.parse::<u64>().ok());
        Some(Self {
            step_instructions: step.parse().ok()?,
            set_instructions: set.parse().ok()?,
            flash_bytes: text.parse().ok()?,
            state_bytes: state.parse().ok()?,
            stack_bytes: depths.collect::<Option<Vec<u64>>>()?.into_iter().max()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_tools_say_is_read() {
        let sizes = "   text\t   data\t    bss\n   3116\t      0\t      0\n";
        let usage = "axis.c:1:6:axis_init\t8\tstatic\naxis.c:9:8:axis_step\t112\tstatic\n";
        let found = CodeCost::read("wrong 0 step 612 set 40 state 188\n", sizes, usage);
        let expected = CodeCost {
            step_instructions: 612,
            set_instructions: 40,
            flash_bytes: 3116,
            state_bytes: 188,
            stack_bytes: 112,
        };
        assert_eq!(found, Some(expected));
    }

    #[test]
    fn a_failed_self_test_has_no_cost() {
        assert_eq!(CodeCost::read("wrong 3 step 612 set 40 state 188", "", ""), None);
    }
}
