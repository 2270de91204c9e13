//! Projects of real and invented machines that the program holds, to begin with: a copy of one is written into a folder and opened.

/// A file of an example.
#[derive(Debug, Clone, Copy)]
pub struct ExampleFile {
    /// The name in the example's folder.
    pub name: &'static str,
    /// The content.
    pub content: &'static [u8],
}

/// A project to begin with.
#[derive(Debug, Clone, Copy)]
pub struct Example {
    /// The name, also of the folder of a copy.
    pub name: &'static str,
    /// The machine in a few words.
    pub title: &'static str,
    /// What the example shows.
    pub summary: &'static str,
    /// The files; the project file is the last one, so that a copy that was interrupted is no project.
    pub files: &'static [ExampleFile],
}

macro_rules! example_files {
    ($folder:literal: $($name:literal),+) => {
        &[$(ExampleFile {
            name: $name,
            content: include_bytes!(concat!("../../examples/", $folder, "/", $name)),
        }),+]
    };
}

/// The examples, the simplest first.
pub const EXAMPLES: [Example; 8] = [
    Example {
        name: "direct-gimbal",
        title: "Pan-tilt head",
        summary: "a direct drive with a gyroscope: few numbers, nothing that yields",
        files: example_files!("direct-gimbal": "project.toml"),
    },
    Example {
        name: "servo-pendulum",
        title: "Pendulum on a servo",
        summary: "a small geared servo that lifts a weight",
        files: example_files!("servo-pendulum": "project.toml"),
    },
    Example {
        name: "ball-screw",
        title: "Ball-screw axis",
        summary: "a linear axis with a cascade of position and rate",
        files: example_files!("ball-screw": "project.toml"),
    },
    Example {
        name: "belt-antenna",
        title: "Antenna behind a belt",
        summary: "a soft transmission; the weights are chosen",
        files: example_files!("belt-antenna": "project.toml"),
    },
    Example {
        name: "ship-antenna",
        title: "Antenna on a ship",
        summary: "a moving platform, with the line of sight",
        files: example_files!("ship-antenna": "README.md", "azimuth.toml", "project.toml"),
    },
    Example {
        name: "crane-cylinder",
        title: "Crane with a cylinder",
        summary: "a boom that a hydraulic cylinder holds still on a vessel",
        files: example_files!("crane-cylinder": "README.md", "project.toml"),
    },
    Example {
        name: "reference-rig",
        title: "Cantilever on a vehicle",
        summary: "everything: flexible, out of balance, friction, backlash, a recorded road",
        files: example_files!("reference-rig": "README.md", "sandy-loam.parquet", "project.toml"),
    },
    Example {
        name: "left-out-friction",
        title: "Recordings to diagnose",
        summary: "recordings of a cantilever with friction that its project lacks",
        files: example_files!("left-out-friction": "README.md", "steps.parquet", "triangle.parquet", "project.toml"),
    },
];

/// Returns the example of a name.
pub fn find_example(name: &str) -> Option<&'static Example> {
    EXAMPLES.iter().find(|example| example.name == name)
}
