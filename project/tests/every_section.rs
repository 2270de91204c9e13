//! Every section of the plant, in machines that hold one key of the reference each at least once: each key left out in turn.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeSet;

use counterpoise_project::{Attachments, Document, Project};

use super::omissions::check_omission;

/// What every sensor may state, in the units of its reading.
const OF_SENSOR: &str = "natural_frequency = 900.0\ndamping_ratio = 0.8\nscale = 5.0\nnoise = 1e-4\ngain = 1.01\nbias = 1e-4\ndelay = 1e-4\ng_sensitivity = 1e-6\nangle_random_walk = 1e-6\nbias_instability = 1e-6\nrate_random_walk = 1e-7\nsample_period = 1e-3\n";

const INTERFACE: &str = "[plant.interface]\nsample_period = 1e-3\ninput_bits = 16\noutput_bits = 12\noutput_delay_samples = 1\nsample_jitter = 1e-6\nmissed_samples = 0.001\nlate_samples = 0.001\nmissing_codes = 0.001\n";

const LIMITS: &str = "[plant.drive_limits]\nslew = 1e4\nmotor_speed = 300.0\nsupply_power = 1e3\ncontinuous_current = 5.0\noverload_time = 2.0
[plant.drive_limits.heat]\nwinding_resistance = 0.5\nhousing_resistance = 1.0\nwinding_time = 30.0\nhousing_time = 900.0\nambient = 300.0\nstart = 310.0\nlimit = 420.0\n";

const LOADS: &str = "[plant.end_stops]\nlower = -1.0\nupper = 1.0\nstiffness = 1e5\ndissipation = 0.5
[plant.recoil]\nshots = [1.0, 2.0]\nimpulse = 100.0\nshot_time = 0.02\nmass = 5.0\nlength = 0.1\nrun_out = 0.5\nheight = 0.01\nbore_offset = 0.01\nahead = 0.1\n";

const SPRING: &str = "[plant.equilibrator]\nkind = \"spring\"\narm = 0.3\narm_angle = 0.1\nanchor = 0.4\nanchor_angle = -1.2\nfactor = 1.1\nstiffness = 2e3\nfree_length = 0.2\n";

const GAS: &str = "[plant.equilibrator]\nkind = \"gas\"\nacts = \"push\"\narm = 0.3\narm_angle = 0.1\nanchor = 0.4\nanchor_angle = -1.2\nfactor = 1.1\npressure = 2e6\narea = 1e-3\nvolume = 1e-3\ncharge_length = 0.4\nexponent = 1.3\ncharge_temperature = 290.0\ntemperature = 300.0\n";

/// What every friction may state.
const OF_FRICTION: &str = "viscous = 0.01\nstribeck_rate = 0.02\nasymmetry = 0.05\nviscous_asymmetry = 0.05\nquadratic = 1e-3\nload_coefficient = 0.01\nwarm_up = 0.1\nwarm_up_time = 60.0\ncoulomb = 0.1\n";

/// The friction laws with the keys of their own.
const LAWS: [&str; 9] = [
    "model = \"dahl\"\nrest_stiffness = 100.0\nexponent = 1.5\n",
    "model = \"lugre\"\nbristle_stiffness = 100.0\nbristle_damping = 0.1\nstatic_ratio = 1.2\n",
    "model = \"reset-integrator\"\nstatic_ratio = 1.2\ndeflection = 1e-3\ndamping = 0.1\n",
    "model = \"stribeck\"\nstatic_ratio = 1.2\ncurve = \"exponential\"\ncurve_exponent = 1.5\n",
    "model = \"stribeck\"\nstatic_ratio = 1.2\ncurve = \"polynomial\"\ncoefficients = [0.1, 0.1, 0.1]\n",
    "model = \"karnopp\"\nstatic_ratio = 1.2\nstick_rate = 1e-3\n",
    "model = \"walrath\"\ntime_constant = 1e-3\nsmoothing_rate = 1e-3\n",
    "model = \"bristle\"\nstatic_ratio = 1.2\nbristles = 10\nbond = 1e-3\n",
    "model = \"coulomb\"\n",
];

fn cylinder() -> String {
    let keys = "area = 4.5e-3\nsupply_pressure = 7.5e6\nvolume = 2e-3\nbulk_modulus = 9e8\nleakage = 1e-11\nrated_flow = 4e-4\nrated_pressure_drop = 6e6\nrated_control = 9.0\nvalve_frequency = 420.0\nvalve_damping = 0.8\noverlap = 0.01\n";
    let lever = "lever_arm = 0.4\n";
    let linkage = "[plant.cylinder.linkage]\narm = 0.5\narm_angle = 0.1\nanchor = 0.9\nanchor_angle = -0.5\n";
    let machine =
        |own: &str| format!("format = 2\n[plant]\ninertia = 200.0\n{INTERFACE}[plant.cylinder]\n{keys}{own}");
    format!("{}\u{0}{}", machine(lever), machine(linkage))
}

/// Returns a beam with a law of damping and a section of a shape.
fn beam(damping: &str, shape: &str) -> String {
    format!(
        "format = 2
[plant.beam]
youngs_modulus = 2e11\npoissons_ratio = 0.29\ndensity = 7850.0\npivot = 0.1\n{damping}
[[plant.beam.section]]
name = \"only\"\nfrom = -0.5\nto = 1.5\n{shape}
[[plant.beam.mass]]
name = \"muzzle\"\nposition = 1.4\nmass = 20.0\ninertia = 0.1\n{INTERFACE}"
    )
}

/// Returns machines that together hold every key of the plant.
fn machines() -> Vec<String> {
    let rotary = |parts: &str| {
        format!("format = 2\n[plant]\nname = \"machine\"\ngravity = 9.8\ninertia = 2.0\n{parts}{INTERFACE}")
    };
    let slide =
        |parts: &str| format!("format = 2\n[plant]\naxis = \"linear\"\nmass = 20.0\n{parts}{INTERFACE}");
    let drive =
        "[plant.drive]\nkind = \"current\"\nlimit = 10.0\nbandwidth = 5e3\ndelay = 1e-4\ndead_zone = 0.01\n";
    let voltage = "[plant.drive]\nkind = \"voltage\"\nlimit = 48.0\ntime_constant = 1e-4\ncurrent_limit = 20.0\nmap = [[1.0, 0.9], [2.0, 1.9]]\n";
    let amplifier = "[plant.amplifier]\ngain = 5.0\ncurrent_feedback = 0.1\ntime_constant = 1e-4\ninput_limit = 10.0\nbus_voltage = 60.0\ndead_zone = 0.01\ncurrent_limit = 20.0\ndynamics = \"modelled\"\nmap = [[1.0, 0.9], [2.0, 1.9]]\n";
    let motor = "[plant.motor]\ninertia = 1e-4\ntorque_constant = 0.1\nback_emf_constant = 0.1\nresistance = 1.0\ninductance = 1e-3\nplatform_coupling = 1.0\n[plant.motor.cogging]\namplitude = 1e-3\norder = 12.0\nphase = 0.1\n[plant.motor.torque_ripple]\namplitude = 1e-2\norder = 6.0\nphase = 0.1\n";
    let gearbox = "[plant.gearbox]\nratio = 50.0\nstiffness = 4e4\ndamping = 10.0\nbacklash = 1e-4\nmesh_efficiency = 0.9\n[plant.gearbox.mesh_ripple]\namplitude = 1e-2\norder = 7.0\nphase = 0.1\n";
    let sensor = |name: &str, more: &str| format!("[plant.sensors.{name}]\n{more}{OF_SENSOR}");
    let base = ["platform_gyro", "motor_tachometer", "hub_resolver"].map(|name| sensor(name, "")).concat()
        + &sensor("platform_accelerometer", "tilt = 0.1\nlever_arm = 0.2\naxis = \"vertical\"\n")
        + &sensor("surge_accelerometer", "tilt = 0.1\n");
    let gyro = sensor("hub_gyro", "roll_sensitivity = 0.01\nyaw_sensitivity = 0.01\n");
    let belt = "[plant.belt]\nratio = 10.0\nstiffness = 2e3\ndamping = 1.0\n";
    let harmonic = "[plant.harmonic_drive]\nratio = 100.0\nstiffness = 2e4\ndamping = 5.0\nhysteresis = 1.0\nhysteresis_stiffness = 3e4\nkinematic_error = 1e-4\n";
    let yielding = "[plant.gearbox]\nratio = 50.0\nstiffness = 4e4\n";
    let screw = "[plant.ball_screw]\nlead = 0.01\nstiffness = 1e7\ndamping = 100.0\nbacklash = 1e-6\nmesh_efficiency = 0.9\n";
    let lumped = "format = 2\n[plant]\n[plant.lumped]\nhub_inertia = 2.0\nbeam_inertia = 1.0\nstiffness = 3e4\ndamping = 2.0\nout_of_balance = 0.5\nvertical_offset = 0.1\nposition_stiffness = 10.0\nposition_stiffness_centre = 0.1\nhysteresis = 0.1\nhysteresis_stiffness = 10.0\n[[plant.lumped.chain]]\ninertia = 0.5\nstiffness = 2e4\ndamping = 1.0\n";
    let sliding = "format = 2\n[plant]\naxis = \"linear\"\n[plant.lumped]\nmass = 2.0\ntip_mass = 1.0\nstiffness = 3e4\ndamping = 2.0\n[[plant.lumped.chain]]\nmass = 0.5\nstiffness = 2e4\ndamping = 1.0\n";
    let friction = |law: &str| format!("[plant.friction.motor]\n{law}{OF_FRICTION}");
    let mut all = vec![
        rotary(&format!("{gearbox}{motor}{drive}{LIMITS}{gyro}{base}{SPRING}{LOADS}")),
        rotary(&format!("{motor}{voltage}{GAS}")),
        rotary(&format!("{motor}{amplifier}")),
        rotary(&format!(
            "{belt}{motor}{}",
            sensor("encoder", "place = \"motor\"\ncounts = 4096\nreads = \"rate\"\n")
        )),
        rotary(&format!("{harmonic}{motor}{}", sensor("resolver", "place = \"motor\"\n"))),
        rotary(&format!("{yielding}{motor}[plant.friction.pivot]\nviscous = 5.0\n{}", sensor("torque", ""))),
        rotary(&sensor("tachometer", "place = \"load\"\n")),
        rotary(&format!(
            "{motor}[plant.drive]\nkind = \"current\"\nbandwidth = 5e3\n[plant.friction.pivot]\nviscous = 5.0\n{}",
            sensor("current", "")
        )),
        slide(&format!("{screw}{motor}{}", sensor("encoder", "resolution = 1e-6\n"))),
        format!("{lumped}{INTERFACE}"),
        format!("{sliding}{INTERFACE}"),
    ];
    all.extend(LAWS.map(|law| rotary(&format!("{motor}{}", friction(law)))));
    let rectangle = "shape = \"rectangle\"\nheight = [0.1, 0.05]\nwidth = [0.08, 0.04]";
    let given = "shape = \"given\"\narea = [8e-3, 2e-3]\nsecond_moment = [6e-6, 4e-7]";
    let rayleigh = "damping = \"rayleigh\"\nrayleigh_first = [100.0, 0.01]\nrayleigh_second = [1000.0, 0.02]";
    all.extend([beam(rayleigh, rectangle), beam("modal_damping = [0.01]", given)]);
    all.extend(cylinder().split('\u{0}').map(str::to_owned));
    all
}

/// Sections whose keys speak of files beside the project.
const OF_FILES: [&str; 2] = ["plant.import", "plant.learned"];

/// A machine of which another test leaves out each key: structure as a beam, with configurations.
const WITH_BEAM: &str = include_str!("data/rig.toml");

/// Returns the paths of the keys of the plant in the reference.
fn keys_of_reference() -> Vec<String> {
    let reference = Project::reference();
    let (mut section, mut keys) = (String::new(), Vec::new());
    for line in reference.lines() {
        if let Some(rest) = line.strip_prefix("## `[") {
            section = rest.split(']').next().unwrap_or_default().to_owned();
        }
        let key = line.strip_prefix("| `").and_then(|rest| rest.split('`').next());
        keys.extend(key.filter(|_| section.starts_with("plant")).map(|key| {
            let lists = ["chain", "beam.section", "beam.mass"];
            let path = format!("{section}.{key}");
            lists.iter().fold(path, |path, list| path.replace(&format!("{list}."), &format!("{list}[0].")))
        }));
    }
    keys
}

/// Returns the paths of the keys that a machine states.
fn written_keys(text: &str) -> BTreeSet<String> {
    let (mut section, mut keys) = (String::new(), BTreeSet::new());
    for line in text.lines() {
        if let Some(list) = line.strip_prefix("[[") {
            section = format!("{}[0]", list.trim_end_matches(']'));
        } else if let Some(table) = line.strip_prefix('[') {
            table.trim_end_matches(']').clone_into(&mut section);
        } else if let Some((key, _)) = line.split_once(" = ") {
            keys.insert(format!("{section}.{}", key.trim()));
        }
    }
    keys
}

#[test]
fn each_key_of_every_section_of_the_plant_is_left_out_once() {
    let reference = keys_of_reference();
    assert!(reference.len() > 300, "{}", reference.len());
    let (mut wrong, mut tested) = (Vec::new(), BTreeSet::new());
    for text in machines() {
        let document = Document::parse(&text, "machine.toml");
        if let Err(errors) = Project::resolve(&document, &Attachments::none()) {
            wrong.push(format!("{errors:?}\n{text}"));
            continue;
        }
        let written = written_keys(&text);
        let of_reference = reference.iter().filter(|path| written.contains(*path));
        wrong.extend(of_reference.filter_map(|path| check_omission(&document.remove(path).unwrap(), path)));
        tested.extend(written);
    }
    assert!(wrong.is_empty(), "{}:\n{}", wrong.len(), wrong.join("\n"));
    tested.extend(written_keys(WITH_BEAM));
    let is_of_files = |path: &str| OF_FILES.iter().any(|section| path.starts_with(section));
    // A key of a list is tested in any of its items.
    let tested: BTreeSet<String> = tested.iter().map(|path| path.replace("[0]", "")).collect();
    let is_tested = |path: &str| tested.contains(&path.replace("[0]", ""));
    let untested: Vec<&String> =
        reference.iter().filter(|path| !is_of_files(path) && !is_tested(path)).collect();
    assert!(untested.is_empty(), "{untested:?}");
}
