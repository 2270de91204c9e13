//! Names that data sheets and other programs give to what a project file calls otherwise.

/// Pairs of a name that people write and the key, seen from the same section, that means it.
const SYNONYMS: &[(&str, &str)] = &[
    ("name", "plant.name"),
    ("sample_period", "plant.interface.sample_period"),
    ("sample_time", "sample_period"),
    ("ts", "sample_period"),
    ("sample_rate", "sample_period"),
    ("sampling_rate", "sample_period"),
    ("sample_frequency", "sample_period"),
    ("sampling_frequency", "sample_period"),
    ("efficiency", "mesh_efficiency"),
    ("voltage", "limit"),
    ("current", "limit"),
    ("bits", "input_bits"),
    ("adc_bits", "input_bits"),
    ("dac_bits", "output_bits"),
    ("bandwidth", "synth.bandwidth"),
    ("resolution", "counts"),
    ("counts", "resolution"),
    ("inertia", "mass"),
    ("hub_inertia", "mass"),
    ("beam_inertia", "tip_mass"),
    ("mass", "inertia"),
    ("mass", "hub_inertia"),
    ("lines", "counts"),
    ("ppr", "counts"),
    ("force_constant", "torque_constant"),
    ("kt", "torque_constant"),
    ("km", "torque_constant"),
    ("ke", "back_emf_constant"),
    ("voltage_constant", "back_emf_constant"),
    ("rotor_inertia", "inertia"),
    ("j", "inertia"),
    ("r", "resistance"),
    ("l", "inductance"),
    ("max_current", "limit"),
    ("friction", "coulomb"),
    ("gyroscope", "hub_gyro"),
    ("gyro", "hub_gyro"),
    ("rate_gyro", "hub_gyro"),
    ("rate_sensor", "hub_gyro"),
    ("tacho", "tachometer"),
    ("accelerometer", "platform_accelerometer"),
    ("heave_accelerometer", "platform_accelerometer"),
    ("pitch_gyro", "platform_gyro"),
    ("base_gyro", "platform_gyro"),
    ("torque_sensor", "torque"),
    ("current_sensor", "current"),
    ("gear", "gearbox"),
    ("gears", "gearbox"),
    ("transmission", "gearbox"),
    ("screw", "ball_screw"),
    ("leadscrew", "ball_screw"),
    ("lead_screw", "ball_screw"),
    ("harmonic", "harmonic_drive"),
    ("strain_wave", "harmonic_drive"),
    ("rope", "cable"),
    ("servo_drive", "drive"),
    ("power_stage", "drive"),
    ("controller", "interface"),
    ("sampling", "interface"),
    ("gear_ratio", "ratio"),
    ("reduction", "ratio"),
    ("pitch", "lead"),
    ("torque_limit", "limit"),
    ("max_torque", "limit"),
    ("peak_torque", "limit"),
    ("max_force", "limit"),
    ("peak_current", "limit"),
    ("current_limit", "limit"),
    ("max_voltage", "limit"),
    ("supply_voltage", "limit"),
    ("bus_voltage", "limit"),
    ("latency", "delay"),
    ("dead_time", "delay"),
    ("transport_delay", "delay"),
    ("cpr", "counts"),
    ("noise_rms", "noise"),
    ("rms_noise", "noise"),
    ("viscous_friction", "viscous"),
    ("coulomb_friction", "coulomb"),
    ("static_friction", "coulomb"),
    ("k", "stiffness"),
    ("spring_constant", "stiffness"),
    ("d", "damping"),
    ("damping_constant", "damping"),
    ("play", "backlash"),
    ("dt", "sample_period"),
    ("period", "sample_period"),
    ("cycle_time", "sample_period"),
];

/// Returns the keys that a name means.
pub(crate) fn keys_meant_by(written: &str) -> impl Iterator<Item = &'static str> {
    let written = written.to_lowercase();
    SYNONYMS.iter().filter(move |(name, _)| *name == written).map(|(_, key)| *key)
}

/// Returns the key that a name means, if it, or the section in which it stands, is known here.
pub(super) fn find_synonym(written: &str, known: &[String]) -> Option<&'static str> {
    let written = written.to_lowercase();
    let here = |key: &str| {
        let first = key.split('.').next().unwrap_or(key);
        known.iter().any(|name| name == first)
    };
    SYNONYMS.iter().find(|(name, key)| *name == written && here(key)).map(|(_, key)| *key)
}
