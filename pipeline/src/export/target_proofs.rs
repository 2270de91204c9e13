//! The answers of compilers and emulators about the generated code, as data. They are run elsewhere.

use counterpoise_export::Numbers;
use counterpoise_export::board::CodeCost;

/// Cost on a core of the code in one kind of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CoreCost {
    /// Name of the core.
    pub core: &'static str,
    /// Numbers of the code.
    pub numbers: Numbers,
    /// Counted cost.
    pub cost: CodeCost,
}

/// Counted costs of a step, and the reasons for those that were not counted.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct StepCosts {
    /// Each core with each kind of numbers.
    pub counted: Vec<CoreCost>,
    /// Why something is missing.
    pub remark: Option<String>,
}

/// Operations of a step, for a reader who has no board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OperationCounts {
    /// Multiplications.
    pub multiplications: usize,
    /// Additions.
    pub additions: usize,
    /// States.
    pub states: usize,
}

impl OperationCounts {
    /// Returns about how many instructions a step in single precision needs: a product and the load of its coefficient, a sum, a load and a
    /// store of each state.
    pub fn instructions_by_hand(self) -> usize {
        2 * self.multiplications + self.additions + 2 * self.states
    }
}

/// Agreement of compiled code with its model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum CodeAgreement {
    /// To the last bit, in every sample.
    Alike {
        /// Samples compared.
        samples: usize,
    },
    /// Not everywhere.
    Otherwise {
        /// Samples compared.
        samples: usize,
        /// Those that differ.
        wrong: usize,
    },
    /// It was not run, and why.
    NotRun(String),
}

/// Code that was compiled and run on this machine.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CompiledCodeTest {
    /// Rust, else C.
    pub rust: bool,
    /// Numbers.
    pub numbers: Numbers,
    /// Answers of the program.
    pub answered: CodeAgreement,
}
