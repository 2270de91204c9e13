//! The bill of materials is that of the lock file, and the page of dependencies agrees with it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::every_example::support;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Returns the bill of materials of the command line; `None` if Python or the crates' sources are not here.
fn bill() -> Option<Value> {
    let output = Command::new(root().join(".ci/sbom")).env("CARGO_NET_OFFLINE", "true").output().ok()?;
    output.status.success().then(|| serde_json::from_slice(&output.stdout).unwrap())
}

/// Names and versions of the packages of the lock file.
fn locked_packages() -> BTreeSet<(String, String)> {
    let text = fs::read_to_string(root().join("Cargo.lock")).unwrap();
    let field = |block: &str, key: &str| {
        let line = block.lines().find_map(|line| line.strip_prefix(&format!("{key} = \"")))?;
        line.strip_suffix('"').map(str::to_owned)
    };
    text.split("[[package]]")
        .filter_map(|block| Some((field(block, "name")?, field(block, "version")?)))
        .collect()
}

#[test]
fn the_bill_of_materials_lists_every_crate_with_licence_and_checksum() {
    let Some(bill) = bill() else {
        return support::report_skip("no Python, or no sources of the crates: no bill of materials");
    };
    assert_eq!((bill["bomFormat"].as_str(), bill["specVersion"].as_str()), (Some("CycloneDX"), Some("1.5")));
    let text = |component: &Value, key: &str| component[key].as_str().unwrap_or_default().to_owned();
    assert_eq!(text(&bill["metadata"]["component"], "name"), "counterpoise");
    let (components, locked) = (bill["components"].as_array().unwrap(), locked_packages());
    for component in components {
        let (name, version) = (text(component, "name"), text(component, "version"));
        assert!(locked.contains(&(name.clone(), version)), "{name} is not in Cargo.lock");
        if !name.starts_with("counterpoise") {
            assert!(component["licenses"][0]["expression"].is_string(), "{name} has no licence");
            assert_eq!(component["hashes"][0]["content"].as_str().map(str::len), Some(64), "{name}");
        }
    }
    let page = fs::read_to_string(root().join("docs/evidence/dependencies.md")).unwrap();
    let counted = format!("{} crates", components.len());
    assert!(page.contains(&counted), "docs/evidence/dependencies.md does not say {counted}");
    for listed in
        page.lines().filter(|line| line.starts_with("| `")).filter_map(|line| line.split('|').nth(1))
    {
        for name in listed.split('`').skip(1).step_by(2) {
            assert!(components.iter().any(|component| component["name"] == name), "{name} is not linked");
        }
    }
}
