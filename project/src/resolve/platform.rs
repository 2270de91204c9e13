//! The `[verify.road]` section: how the platform moves, from a recording, a spectrum, a motion simulator, a road or a sea.

use counterpoise_models::base_motion::Traverse;
use counterpoise_verify::signals::iso_road::check_vehicle;
use counterpoise_verify::signals::sea::Sea;
use counterpoise_verify::signals::six_axes::SixAxes;
use counterpoise_verify::signals::spectrum::{
    MotionRealisation, check_density, check_pitch_simulator, sine_tones,
};
use counterpoise_verify::signals::{RoadClass, Vehicle};

use super::base_motion::{self, InertialUnit};
use super::carrier;
use super::seed::seed;
use crate::file::field::{Field, NumberRange};
use crate::file::visit::{NamedChoice, Visit, choose, maybe_number};

/// Source of the platform's motion.
#[derive(Debug, Clone, PartialEq)]
pub enum PlatformSource {
    /// A recording of a platform in motion.
    Recording(RoadSource),
    /// A motion made from numbers.
    Made(GeneratedMotion),
    /// A recording of an inertial measurement unit.
    InertialUnit(InertialUnit),
}

impl PlatformSource {
    /// Returns the name of the recording that the motion comes from; `None` if it is made from numbers.
    pub fn recording(&self) -> Option<&str> {
        match self {
            Self::Recording(source) => Some(&source.recording),
            Self::InertialUnit(unit) => Some(&unit.recording),
            Self::Made(_) => None,
        }
    }
}

/// A recording of a platform in motion, and how it is taken.
#[derive(Debug, Clone, PartialEq)]
pub struct RoadSource {
    /// Name of the recording, in the folder of the project file.
    pub recording: String,
    /// Column of the upward acceleration; its mean (gravity) is removed.
    pub heave: String,
    /// Column of the pitch rate; its mean is removed.
    pub pitch: String,
    /// Column of the forward acceleration; its mean is removed. Empty: there is no surge.
    pub surge: String,
    /// Factor on surge; a negative one turns the sign.
    pub surge_scale: f64,
    /// Factor on heave; a negative one turns the sign.
    pub heave_scale: f64,
    /// Factor on pitch; a negative one turns the sign.
    pub pitch_scale: f64,
    /// Both are low-passed at this frequency without shift, Hz; `None` leaves them.
    pub low_pass_hz: Option<f64>,
    /// Start in the recording, s.
    pub start_s: f64,
    /// Length taken, s.
    pub duration_s: f64,
    /// Motion fades in and out over this time, s.
    pub fade_s: f64,
}

/// A motion made from numbers, the same for the same seed.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneratedMotion {
    /// Source from which it is generated.
    pub kind: MotionKind,
    /// Duration, fades and seed.
    pub realisation: MotionRealisation,
}

/// Source from which a motion is generated.
#[derive(Debug, Clone, PartialEq)]
pub enum MotionKind {
    /// Independent heave and pitch of given spectra.
    Spectrum {
        /// Points of the heave's density, [Hz, (m/s^2)^2/Hz].
        heave_psd: Vec<[f64; 2]>,
        /// Points of the pitch rate's density, [Hz, (rad/s)^2/Hz].
        pitch_psd: Vec<[f64; 2]>,
    },
    /// A platform motion simulator that only pitches.
    Simulator {
        /// The pivot's distance in front of its axis, m: heave is that x pitch acceleration.
        offset_m: f64,
        /// Sines of the pitch angle, [rad, Hz].
        sines: Vec<[f64; 2]>,
        /// Points of the pitch rate's density, [Hz, (rad/s)^2/Hz].
        pitch_psd: Vec<[f64; 2]>,
    },
    /// A drive of a wheeled vehicle over a road of ISO 8608.
    IsoRoad {
        /// Roughness of the road.
        class: RoadClass,
        /// Speed of the vehicle, m/s.
        speed_m_s: f64,
        /// The vehicle.
        vehicle: Vehicle,
    },
    /// A ship in irregular waves.
    Sea(Box<Sea>),
    /// Sines and spectra of each of the base's six axes.
    SixAxes(Box<SixAxes>),
}

/// The source of a motion, by name.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Recording,
    Spectrum,
    Simulator,
    IsoRoad,
    SixAxes,
    Sea,
    InertialUnit,
}

impl NamedChoice for Kind {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("recording", Self::Recording),
        ("spectrum", Self::Spectrum),
        ("simulator", Self::Simulator),
        ("iso-8608", Self::IsoRoad),
        ("six-axes", Self::SixAxes),
        ("sea", Self::Sea),
        ("inertial-unit", Self::InertialUnit),
    ];
}

impl NamedChoice for RoadClass {
    const NAMES: &'static [(&'static str, Self)] =
        &[("A", Self::A), ("B", Self::B), ("C", Self::C), ("D", Self::D), ("E", Self::E)];
}

const ABOVE_0: NumberRange = NumberRange::Above(0.0);
const AT_LEAST_0: NumberRange = NumberRange::AtLeast(0.0);
/// Duration where the file does not say, s.
const DURATION_S: f64 = 30.0;

impl GeneratedMotion {
    /// Checks whether the motion can be realised.
    ///
    /// # Errors
    /// Those of the checks of each kind of motion in `verify::signals`.
    fn check(&self) -> Result<(), counterpoise_verify::Error> {
        match &self.kind {
            MotionKind::Spectrum { heave_psd, pitch_psd } => {
                check_density(heave_psd)?;
                check_density(pitch_psd)
            }
            MotionKind::Simulator { offset_m, sines, pitch_psd } => {
                check_density(pitch_psd)?;
                check_pitch_simulator(&sine_tones(sines), *offset_m)
            }
            MotionKind::IsoRoad { speed_m_s, vehicle, .. } => check_vehicle(*speed_m_s, *vehicle),
            MotionKind::Sea(sea) => sea.check(),
            MotionKind::SixAxes(motion) => motion.check(),
        }
    }
}

/// Returns a recording of which nothing is known yet.
pub(crate) fn blank_source() -> PlatformSource {
    PlatformSource::Recording(blank_recording())
}

fn blank_recording() -> RoadSource {
    RoadSource {
        recording: String::new(),
        heave: String::new(),
        pitch: String::new(),
        surge: String::new(),
        surge_scale: 1.0,
        heave_scale: 1.0,
        pitch_scale: 1.0,
        low_pass_hz: None,
        start_s: 0.0,
        duration_s: f64::NAN,
        fade_s: 1.0,
    }
}

fn kind(source: &PlatformSource) -> Kind {
    match source {
        PlatformSource::Recording(_) => Kind::Recording,
        PlatformSource::Made(motion) => match motion.kind {
            MotionKind::Spectrum { .. } => Kind::Spectrum,
            MotionKind::Simulator { .. } => Kind::Simulator,
            MotionKind::IsoRoad { .. } => Kind::IsoRoad,
            MotionKind::SixAxes(_) => Kind::SixAxes,
            MotionKind::Sea(_) => Kind::Sea,
        },
        PlatformSource::InertialUnit(_) => Kind::InertialUnit,
    }
}

fn blank_of(kind: Kind) -> PlatformSource {
    let empty = Vec::new;
    let made = |kind| {
        let realisation = MotionRealisation { duration_s: DURATION_S, fade_s: 1.0, seed: 1 };
        PlatformSource::Made(GeneratedMotion { kind, realisation })
    };
    match kind {
        Kind::Recording => blank_source(),
        Kind::Spectrum => made(MotionKind::Spectrum { heave_psd: empty(), pitch_psd: empty() }),
        Kind::Simulator => {
            made(MotionKind::Simulator { offset_m: f64::NAN, sines: empty(), pitch_psd: empty() })
        }
        Kind::IsoRoad => {
            made(MotionKind::IsoRoad { class: RoadClass::C, speed_m_s: f64::NAN, vehicle: Vehicle::HEAVY })
        }
        Kind::Sea => made(MotionKind::Sea(Box::new(carrier::blank_sea()))),
        Kind::SixAxes => made(MotionKind::SixAxes(Box::new(SixAxes {
            axes: Default::default(),
            coherence: 0.0,
            traverse: Traverse::default(),
        }))),
        Kind::InertialUnit => PlatformSource::InertialUnit(base_motion::blank_inertial_unit()),
    }
}

/// Reads or lists the platform's motion.
pub(crate) fn platform(v: &mut dyn Visit, source: &mut PlatformSource) {
    let mut chosen = kind(source);
    choose(v, &Field::new("kind", "where the motion comes from").or_text("recording"), &mut chosen);
    if let Some(meant) = meant_without_kind(v) {
        let allowed = format!(
            "must be \"{}\" with these keys: where the motion comes from is not stated",
            meant.name()
        );
        v.complain("kind", &allowed, None);
        chosen = meant;
    }
    if chosen != kind(source) {
        *source = blank_of(chosen);
    }
    match source {
        PlatformSource::Recording(road) => recording(v, road),
        PlatformSource::Made(motion) => visit_generated_motion(v, motion),
        PlatformSource::InertialUnit(unit) => base_motion::inertial_unit(v, unit),
    }
}

/// Returns the kind of a motion that the keys belong to, if the file does not state it and it is not the usual one.
fn meant_without_kind(v: &dyn Visit) -> Option<Kind> {
    if v.has("kind") {
        return None;
    }
    // a recording's columns tell whether it is of two motions or of an inertial unit
    if v.has("recording") {
        return (v.has("acceleration") || v.has("rate")).then_some(Kind::InertialUnit);
    }
    let kinds = [
        ("significant_height", Kind::Sea),
        ("peak_period", Kind::Sea),
        ("speed", Kind::IsoRoad),
        ("surge_sines", Kind::SixAxes),
        ("surge_psd", Kind::SixAxes),
        ("heave_sines", Kind::SixAxes),
        ("roll_sines", Kind::SixAxes),
        ("sines", Kind::Simulator),
        ("offset", Kind::Simulator),
        ("heave_psd", Kind::Spectrum),
        ("pitch_psd", Kind::Spectrum),
    ];
    kinds.into_iter().find(|(key, _)| v.has(key)).map(|(_, kind)| kind)
}

fn recording(v: &mut dyn Visit, road: &mut RoadSource) {
    v.text(
        &Field::new("recording", "name of the recording, in the folder of the project file"),
        &mut road.recording,
    );
    v.text(&Field::new("heave", "column of the upward acceleration"), &mut road.heave);
    v.text(&Field::new("pitch", "column of the pitch rate"), &mut road.pitch);
    let surge = "column of the forward acceleration; without it the platform does not surge";
    v.text(&Field::new("surge", surge).or_text(""), &mut road.surge);
    let scale = "factor; a negative one turns the sign";
    v.number(&Field::new("heave_scale", scale).or(1.0).show_default(), &mut road.heave_scale);
    v.number(&Field::new("pitch_scale", scale).or(1.0).show_default(), &mut road.pitch_scale);
    v.number(&Field::new("surge_scale", scale).or(1.0), &mut road.surge_scale);
    let low_pass =
        Field::new("low_pass", "frequency above which motion is removed").unit("Hz").limit(ABOVE_0);
    maybe_number(v, &low_pass, &mut road.low_pass_hz);
    v.number(
        &Field::new("start", "start of the used part in the recording").unit("s").limit(AT_LEAST_0).or(0.0),
        &mut road.start_s,
    );
    v.number(&Field::new("duration", "length that is used").unit("s").limit(ABOVE_0), &mut road.duration_s);
    v.number(
        &Field::new("fade", "time in which the motion fades in and out")
            .unit("s")
            .limit(AT_LEAST_0)
            .or(1.0)
            .show_default(),
        &mut road.fade_s,
    );
}

fn visit_generated_motion(v: &mut dyn Visit, motion: &mut GeneratedMotion) {
    match &mut motion.kind {
        MotionKind::Spectrum { heave_psd, pitch_psd } => {
            let heave = "points of the heave's spectral density, or the name of a CSV file";
            v.pairs(
                &Field::new("heave_psd", heave).units("Hz", "(m/s^2)^2/Hz").limit(ABOVE_0).or_empty(),
                heave_psd,
            );
            density_of_pitch(v, pitch_psd);
        }
        MotionKind::Simulator { offset_m, sines, pitch_psd } => {
            let offset = "distance of the pivot in front of the simulator's axis";
            v.number(&Field::new("offset", offset).unit("m"), offset_m);
            let angle =
                "sines of the pitch angle, each by amplitude and frequency, or the name of a CSV file";
            v.pairs(&Field::new("sines", angle).units("rad", "Hz").limit(ABOVE_0).or_empty(), sines);
            density_of_pitch(v, pitch_psd);
        }
        MotionKind::IsoRoad { class, speed_m_s, vehicle } => {
            choose(
                v,
                &Field::new("class", "class of the road's roughness, A (very good) to E (very poor)")
                    .or_text("C"),
                class,
            );
            v.number(&Field::new("speed", "speed of the vehicle").unit("m/s").limit(ABOVE_0), speed_m_s);
            carrier::vehicle(v, vehicle);
        }
        MotionKind::Sea(sea) => carrier::sea(v, sea),
        MotionKind::SixAxes(motion) => base_motion::six_axes(v, motion),
    }
    let how = &mut motion.realisation;
    let duration = Field::new("duration", "of the motion").unit("s").limit(ABOVE_0);
    v.number(&duration.or(DURATION_S).show_default(), &mut how.duration_s);
    v.number(
        &Field::new("fade", "time in which the motion fades in and out")
            .unit("s")
            .limit(AT_LEAST_0)
            .or(1.0)
            .show_default(),
        &mut how.fade_s,
    );
    seed(v, "seed of the random phases", &mut how.seed);
    judge(v, motion);
}

fn density_of_pitch(v: &mut dyn Visit, pitch_psd: &mut Vec<[f64; 2]>) {
    let pitch = "points of the pitch rate's spectral density, or the name of a CSV file";
    v.pairs(&Field::new("pitch_psd", pitch).units("Hz", "(rad/s)^2/Hz").limit(ABOVE_0).or_empty(), pitch_psd);
}

/// Says what the generators would refuse, at the key that is to blame.
fn judge(v: &mut dyn Visit, motion: &GeneratedMotion) {
    let (key, nothing) = match &motion.kind {
        MotionKind::Spectrum { heave_psd, pitch_psd } => {
            let key = if heave_psd.is_empty() { "pitch_psd" } else { "heave_psd" };
            (key, heave_psd.is_empty() && pitch_psd.is_empty())
        }
        MotionKind::Simulator { sines, pitch_psd, .. } => {
            (if sines.is_empty() { "pitch_psd" } else { "sines" }, sines.is_empty() && pitch_psd.is_empty())
        }
        MotionKind::IsoRoad { .. } => ("speed", false),
        MotionKind::SixAxes(motion) => ("kind", motion.is_still()),
        MotionKind::Sea(_) => ("significant_height", false),
    };
    let is_unread = match motion.kind {
        MotionKind::Simulator { offset_m, .. } => offset_m.is_nan(),
        MotionKind::IsoRoad { speed_m_s, .. } => speed_m_s.is_nan(),
        MotionKind::Sea(ref sea) => carrier::is_unread(sea),
        MotionKind::Spectrum { .. } | MotionKind::SixAxes(_) => false,
    };
    if is_unread {
        return;
    }
    if nothing {
        v.complain("kind", "has nothing that moves: give a density or, for the simulator, sines", None);
        return;
    }
    let how = motion.realisation;
    if 2.0 * how.fade_s > how.duration_s {
        v.complain("fade", &format!("must be at most half the duration of {} s", how.duration_s), None);
        return;
    }
    if let Err(error) = motion.check() {
        v.complain(key, &format!("cannot be realised: {error}"), None);
    }
}
