//! Regenerates the tables of `docs/reference/project-file.md` from the walk that reads project files; the introduction stays.

use counterpoise_project::Project;

fn main() -> std::io::Result<()> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/reference/project-file.md");
    let written = std::fs::read_to_string(path)?;
    let introduction = written.find("\n## at the top").unwrap_or(written.len());
    std::fs::write(path, format!("{}{}", &written[..introduction], Project::reference()))
}
