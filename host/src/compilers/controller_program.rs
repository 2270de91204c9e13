//! The exported C code in the loop: compiled on this machine, and run beside the simulator a sample at a time.

use std::io::{Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use anyhow::{Context, Result, bail};
use counterpoise_controller::{READINGS, Readings, SampledController};
use counterpoise_export::host::{C_COMPILER, C_FLAGS};

use crate::files;

/// A compiled controller that runs as a program of its own.
pub struct ControllerProgram {
    child: Child,
    input: ChildStdin,
    output: ChildStdout,
    has_failed: bool,
}

impl ControllerProgram {
    /// Compiles `machine_step.c` of a folder with an exported controller, and starts it.
    ///
    /// # Errors
    /// There is no C compiler, it fails, or the program cannot be started.
    pub fn start(folder: &Path) -> Result<Self> {
        let scratch = files::scratch_folder().context("no temporary folder")?;
        let program = scratch.path().join("step");
        // The last of the flags names a folder of this compiler's own runs; here the code lies elsewhere.
        let flags = &C_FLAGS[..C_FLAGS.len() - 2];
        let compiled = Command::new(C_COMPILER)
            .args(flags)
            .arg("-DMACHINE_PROGRAM")
            .arg("-iquote")
            .arg(folder)
            .arg("-o")
            .arg(&program)
            .arg(folder.join("machine_step.c"))
            .output()
            .with_context(|| format!("the C compiler `{C_COMPILER}` cannot be started"))?;
        if !compiled.status.success() {
            let said = String::from_utf8_lossy(&compiled.stderr);
            bail!(
                "{C_COMPILER} cannot compile {}: {}",
                folder.display(),
                said.lines().next().unwrap_or("no reason")
            );
        }
        let mut child = Command::new(&program)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .context("the compiled controller cannot be started")?;
        let (input, output) = (child.stdin.take(), child.stdout.take());
        match (input, output) {
            (Some(input), Some(output)) => Ok(Self { child, input, output, has_failed: false }),
            _ => bail!("the compiled controller has no input or output"),
        }
    }

    /// Returns whether the program ended before it answered every sample.
    pub fn has_failed(&self) -> bool {
        self.has_failed
    }

    fn answer(&mut self, readings: &[f64; READINGS]) -> std::io::Result<f64> {
        let bytes: Vec<u8> = readings.iter().flat_map(|value| value.to_ne_bytes()).collect();
        self.input.write_all(&bytes)?;
        self.input.flush()?;
        let mut answer = [0; 8];
        self.output.read_exact(&mut answer)?;
        Ok(f64::from_ne_bytes(answer))
    }
}

impl Drop for ControllerProgram {
    fn drop(&mut self) {
        // It ends by itself when its input closes; one that hangs must not outlive its run.
        drop(self.child.kill());
        drop(self.child.wait());
    }
}

impl SampledController for ControllerProgram {
    /// Nothing: the program begins at its start, and runs once.
    fn reset(&mut self) {}

    /// Returns the answer of the program; 0 from the sample on at which it ended ([`ControllerProgram::has_failed`]).
    fn step(&mut self, readings: &Readings) -> f64 {
        let all = readings.to_array();
        match self.answer(&all) {
            Ok(control_v) => control_v,
            Err(_) => {
                self.has_failed = true;
                0.0
            }
        }
    }
}
