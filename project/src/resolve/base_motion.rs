//! The base's motion in six degrees of freedom, in `[verify.road]`: an inertial measurement unit's recording, and motion of each axis.

use counterpoise_models::base_motion::Traverse;
use counterpoise_verify::signals::six_axes::SixAxes;

use crate::file::field::{Field, NumberRange};
use crate::file::visit::{Count, NamedChoice, Visit, choose, maybe_number};

/// A recording of an inertial measurement unit on the base.
#[derive(Debug, Clone, PartialEq)]
pub struct InertialUnit {
    /// Name of the recording, in the folder of the project file.
    pub recording: String,
    /// Columns of the accelerations along the unit's x, y and z axes.
    pub acceleration: [String; 3],
    /// Columns of the rates about them.
    pub rate: [String; 3],
    /// Quantities of the accelerations.
    pub reading: UnitReading,
    /// Angles by which the unit is turned from the base's axes about x, then y, then z, rad.
    pub mounting_rad: [f64; 3],
    /// From the unit to the pivot, along the base's axes, m.
    pub lever_arm_m: [f64; 3],
    /// The ring on which the elevation axis stands.
    pub traverse: Traverse,
    /// All columns are low-passed at this frequency without shift, Hz; `None` leaves them.
    pub low_pass_hz: Option<f64>,
    /// Start in the recording, s.
    pub start_s: f64,
    /// Length taken, s.
    pub duration_s: f64,
    /// Motion fades in and out over this time, s.
    pub fade_s: f64,
}

/// Quantities that the accelerometers of an inertial unit give.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnitReading {
    /// Acceleration less gravity, in axes that turn with the base: what a strapped-down accelerometer reads.
    SpecificForce,
    /// Acceleration without gravity, in axes that stay level: what a navigation system gives.
    Acceleration,
}

impl NamedChoice for UnitReading {
    const NAMES: &'static [(&'static str, Self)] =
        &[("specific-force", Self::SpecificForce), ("acceleration", Self::Acceleration)];
}

const ABOVE_0: NumberRange = NumberRange::Above(0.0);
const AT_LEAST_0: NumberRange = NumberRange::AtLeast(0.0);
const LEVER: NumberRange = NumberRange::Between(-100.0, 100.0);

/// Returns a unit of which nothing is known yet.
pub(super) fn blank_inertial_unit() -> InertialUnit {
    InertialUnit {
        recording: String::new(),
        acceleration: Default::default(),
        rate: Default::default(),
        reading: UnitReading::SpecificForce,
        mounting_rad: [0.0; 3],
        lever_arm_m: [0.0; 3],
        traverse: Traverse::default(),
        low_pass_hz: None,
        start_s: 0.0,
        duration_s: f64::NAN,
        fade_s: 1.0,
    }
}

/// Reads or lists a unit.
pub(super) fn inertial_unit(v: &mut dyn Visit, unit: &mut InertialUnit) {
    v.text(
        &Field::new("recording", "name of the recording, in the folder of the project file"),
        &mut unit.recording,
    );
    columns(
        v,
        "acceleration",
        "columns of the accelerations along x (forward), y (left) and z (up)",
        &mut unit.acceleration,
    );
    columns(v, "rate", "columns of the rates about x, y and z", &mut unit.rate);
    let reading = Field::new(
        "reading",
        "whether the accelerations contain gravity (specific-force: along axes that turn with the base) or not (acceleration: along axes that stay level)",
    );
    choose(v, &reading.or_text("specific-force"), &mut unit.reading);
    let angles = "angles by which the unit is turned from the base's axes about x, then y, then z";
    read_three_numbers(
        v,
        &Field::new("mounting", angles).unit("rad").limit(NumberRange::Between(-7.0, 7.0)),
        &mut unit.mounting_rad,
    );
    let arm = "from the unit to the pivot along x, y and z of the base";
    read_three_numbers(v, &Field::new("lever_arm", arm).unit("m").limit(LEVER), &mut unit.lever_arm_m);
    visit_traverse(v, &mut unit.traverse);
    let low_pass =
        Field::new("low_pass", "frequency above which motion is removed").unit("Hz").limit(ABOVE_0);
    maybe_number(v, &low_pass, &mut unit.low_pass_hz);
    let start = Field::new("start", "start of the used part in the recording").unit("s").limit(AT_LEAST_0);
    v.number(&start.or(0.0), &mut unit.start_s);
    v.number(&Field::new("duration", "length that is used").unit("s").limit(ABOVE_0), &mut unit.duration_s);
    let fade = Field::new("fade", "time in which the motion fades in and out").unit("s").limit(AT_LEAST_0);
    v.number(&fade.or(1.0).show_default(), &mut unit.fade_s);
}

fn columns(v: &mut dyn Visit, key: &'static str, meaning: &'static str, names: &mut [String; 3]) {
    let blank = names.iter().all(String::is_empty);
    let mut list: Vec<String> = if blank { Vec::new() } else { names.to_vec() };
    v.texts(&Field::new(key, meaning), &mut list);
    match <[String; 3]>::try_from(list) {
        Ok(three) => *names = three,
        Err(list) if list.is_empty() => {}
        Err(list) => {
            v.complain(
                key,
                &format!("must name three columns, for x, y and z; these are {}", list.len()),
                None,
            );
        }
    }
}

/// Three numbers, 0 if the key is absent.
pub(super) fn read_three_numbers(v: &mut dyn Visit, field: &Field, value: &mut [f64; 3]) {
    let mut list = if *value == [0.0; 3] { Vec::new() } else { value.to_vec() };
    v.numbers(&field.or_empty(), Count::Exactly(3), &mut list);
    *value = <[f64; 3]>::try_from(list).unwrap_or([0.0; 3]);
}

pub(super) fn visit_traverse(v: &mut dyn Visit, traverse: &mut Traverse) {
    let angle = "angle of the ring on which the elevation axis stands, at the start, positive to the left";
    v.number(
        &Field::new("traverse_angle", angle).unit("rad").limit(NumberRange::Between(-7.0, 7.0)).or(0.0),
        &mut traverse.angle_rad,
    );
    let rate = "rate of that ring relative to the base";
    v.number(
        &Field::new("traverse_rate", rate).unit("rad/s").limit(NumberRange::Between(-20.0, 20.0)).or(0.0),
        &mut traverse.rate_rad_s,
    );
}

/// Keys of the sines and of the spectrum of each axis, with their meaning, in the order of [`SixAxes::axes`].
const KEYS: [[[&str; 2]; 2]; 6] = [
    [
        [
            "surge_sines",
            "sines of the forward acceleration, each by amplitude and frequency, or the name of a CSV file",
        ],
        ["surge_psd", "points of the forward acceleration's spectral density, or the name of a CSV file"],
    ],
    [
        ["sway_sines", "sines of the acceleration to the left"],
        ["sway_psd", "points of the spectral density of the acceleration to the left"],
    ],
    [
        ["heave_sines", "sines of the upward acceleration"],
        ["heave_psd", "points of the upward acceleration's spectral density"],
    ],
    [
        ["roll_sines", "sines of the rate about the forward axis, positive where the left side rises"],
        ["roll_psd", "points of the roll rate's spectral density"],
    ],
    [
        ["pitch_sines", "sines of the pitch rate, nose-up"],
        ["pitch_psd", "points of the pitch rate's spectral density"],
    ],
    [
        ["yaw_sines", "sines of the yaw rate, to the left"],
        ["yaw_psd", "points of the yaw rate's spectral density"],
    ],
];

/// Reads or lists the motion of each axis.
pub(super) fn six_axes(v: &mut dyn Visit, motion: &mut SixAxes) {
    for (k, [[sines, of_sines], [psd, of_psd]]) in KEYS.into_iter().enumerate() {
        let (unit, density) = if k < 3 { ("m/s^2", "(m/s^2)^2/Hz") } else { ("rad/s", "(rad/s)^2/Hz") };
        let axis = &mut motion.axes[k];
        v.pairs(&Field::new(sines, of_sines).units(unit, "Hz").limit(ABOVE_0).or_empty(), &mut axis.sines);
        v.pairs(&Field::new(psd, of_psd).units("Hz", density).limit(ABOVE_0).or_empty(), &mut axis.psd);
    }
    let coherence = "coherence (magnitude squared) between the spectra of any two axes";
    v.number(
        &Field::new("coherence", coherence).limit(NumberRange::Between(0.0, 1.0)).or(0.0),
        &mut motion.coherence,
    );
    visit_traverse(v, &mut motion.traverse);
}
