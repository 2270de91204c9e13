//! Writes the tables of `project/REFERENCE.md` anew, from the walk that reads project files; its introduction stays.

use counterpoise_project::Project;

fn main() -> std::io::Result<()> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/REFERENCE.md");
    let written = std::fs::read_to_string(path)?;
    let introduction = written.find("\n## ").unwrap_or(written.len());
    std::fs::write(path, format!("{}{}", &written[..introduction], Project::reference()))
}
