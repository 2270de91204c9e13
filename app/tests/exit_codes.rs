//! The exit codes of the commands page: what is documented is what a shell gets.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::process::{Command, Output, Stdio};

use crate::support;

use support::{counterpoise, quick_folder, report_skip};

/// A compiler that changes the controller's answer by a millionth before it compiles it.
const WRONG_COMPILER: &str = r#"#!/bin/sh
for file in *.c */*.c; do
    [ -f "$file" ] && sed -i 's/return g->control_v;/return g->control_v * 1.000001;/' "$file"
done
exec REAL "$@"
"#;

/// Returns the path of the C compiler; `None` if there is none.
fn compiler() -> Option<String> {
    let found = Command::new("sh").args(["-c", "command -v cc"]).stdin(Stdio::null()).output().ok()?;
    let path = String::from_utf8(found.stdout).ok()?.trim().to_owned();
    (!path.is_empty()).then_some(path)
}

/// Runs `design` on a folder, with another folder before all others in which programs are looked for.
fn design(project: &std::path::Path, programs: &std::path::Path) -> Output {
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap());
    let mut command = counterpoise();
    command.arg("design").arg(project).arg("-o").arg(project.join("out")).arg("-q").env("PATH", path);
    command.output().unwrap()
}

#[test]
fn compiled_code_that_differs_from_its_model_gives_code_1() {
    let Some(real) = compiler() else { return report_skip("no C compiler: no wrong one to try") };
    let project = quick_folder("exit_codes_wrong_compiler");
    let programs = project.join("programs");
    fs::create_dir_all(&programs).unwrap();
    let honest = design(&project, &programs);
    assert_eq!(honest.status.code(), Some(0), "{}", String::from_utf8_lossy(&honest.stderr));
    let fake = programs.join("cc");
    fs::write(&fake, WRONG_COMPILER.replace("REAL", &real)).unwrap();
    fs::set_permissions(&fake, fs::Permissions::from_mode(0o755)).unwrap();
    let wrong = design(&project, &programs);
    let said = String::from_utf8_lossy(&wrong.stderr).into_owned();
    assert_eq!(wrong.status.code(), Some(1), "{said}");
    assert!(said.contains("FAILS  compiled C in double numbers"), "{said}");
    assert!(said.contains("samples differ from its model"), "{said}");
}

/// A compiler that fails is no verdict: the comparison was not made, and that is said.
#[test]
fn a_compiler_that_fails_is_said_and_is_no_verdict() {
    if compiler().is_none() {
        return report_skip("no C compiler: none to fail");
    }
    let project = quick_folder("exit_codes_failing_compiler");
    let programs = project.join("programs");
    fs::create_dir_all(&programs).unwrap();
    let fake = programs.join("cc");
    fs::write(&fake, "#!/bin/sh\n[ \"$1\" = --version ] && exit 0\necho 'cc: out of order' >&2\nexit 1\n")
        .unwrap();
    fs::set_permissions(&fake, fs::Permissions::from_mode(0o755)).unwrap();
    let found = design(&project, &programs);
    let said = String::from_utf8_lossy(&found.stderr).into_owned();
    assert_eq!(found.status.code(), Some(0), "{said}");
    assert!(said.contains("was not compared with its model") && said.contains("out of order"), "{said}");
}
