//! The carrier of the platform in `[verify.road]`: the vehicle on a road, and the ship in a sea.

use counterpoise_models::base_motion::Traverse;
use counterpoise_verify::signals::sea::{Sea, Ship, WaveShape, Waves};
use counterpoise_verify::signals::{Sides, Vehicle};

use super::base_motion::{read_three_numbers, visit_traverse};
use crate::file::field::{Field, NumberRange};
use crate::file::visit::{NamedChoice, Visit, choose, maybe_number};

const ABOVE_0: NumberRange = NumberRange::Above(0.0);

impl NamedChoice for WaveShape {
    const NAMES: &'static [(&'static str, Self)] =
        &[("pierson-moskowitz", Self::PiersonMoskowitz), ("jonswap", Self::Jonswap)];
}

/// Radius of gyration of a body about its roll axis, over the track: between 0.3 and 0.45 for road vehicles (J. Wong, Theory of Ground
/// Vehicles, 4th ed. 2008, ch. 7).
const ROLL_GYRATION: f64 = 0.4;

/// Reads or lists the vehicle.
pub(super) fn vehicle(v: &mut dyn Visit, vehicle: &mut Vehicle) {
    let usual = Vehicle::HEAVY;
    let mut positive = |key, meaning, unit, usual: f64, value: &mut f64| {
        v.number(&Field::new(key, meaning).unit(unit).limit(ABOVE_0).or(usual), value);
    };
    positive("body_mass", "mass of the vehicle's body", "kg", usual.body_mass_kg, &mut vehicle.body_mass_kg);
    positive(
        "pitch_inertia",
        "pitch inertia of the body about its centre of mass",
        "kg m^2",
        usual.pitch_inertia_kg_m2,
        &mut vehicle.pitch_inertia_kg_m2,
    );
    positive(
        "axle_mass",
        "mass of each axle with its wheels",
        "kg",
        usual.axle_mass_kg,
        &mut vehicle.axle_mass_kg,
    );
    positive(
        "suspension_stiffness",
        "stiffness of each axle's suspension",
        "N/m",
        usual.suspension_n_m,
        &mut vehicle.suspension_n_m,
    );
    positive(
        "suspension_damping",
        "damping of each axle's suspension",
        "N s/m",
        usual.damping_n_s_m,
        &mut vehicle.damping_n_s_m,
    );
    positive(
        "tyre_stiffness",
        "stiffness of the tyres of each axle",
        "N/m",
        usual.tyre_n_m,
        &mut vehicle.tyre_n_m,
    );
    positive(
        "half_base",
        "distance of each axle from the centre of mass",
        "m",
        usual.half_base_m,
        &mut vehicle.half_base_m,
    );
    let pivot = "distance of the pivot in front of the vehicle's centre of mass";
    v.number(&Field::new("pivot_forward", pivot).unit("m").or(usual.pivot_m), &mut vehicle.pivot_m);
    sides(v, vehicle);
}

/// Without a track both sides see the same road, and the vehicle does not roll.
fn sides(v: &mut dyn Visit, vehicle: &mut Vehicle) {
    let mut track_m = vehicle.sides.map(|sides| sides.track_m);
    let track = "distance of the left wheels from the right ones; without it both sides see the same road, and the vehicle does not roll";
    maybe_number(v, &Field::new("track", track).unit("m").limit(ABOVE_0), &mut track_m);
    let usual = vehicle.body_mass_kg * (ROLL_GYRATION * track_m.unwrap_or_default()).powi(2);
    let stated = vehicle.sides.map(|sides| sides.roll_inertia_kg_m2);
    let mut roll_inertia = stated.filter(|inertia| *inertia != usual);
    let meaning = "roll inertia of the body; without it the body's mass at 0.4 times the track";
    maybe_number(v, &Field::new("roll_inertia", meaning).unit("kg m^2").limit(ABOVE_0), &mut roll_inertia);
    let mut pivot_height_m = vehicle.sides.map_or(0.0, |sides| sides.pivot_height_m);
    let height = "height of the pivot above the axis about which the body rolls";
    v.number(&Field::new("pivot_height", height).unit("m").or(0.0), &mut pivot_height_m);
    if track_m.is_none() {
        let idle: Vec<&str> = ["roll_inertia", "pivot_height"].into_iter().filter(|key| v.has(key)).collect();
        for key in idle {
            v.complain(
                key,
                "has no effect without `track`, the distance of the left wheels from the right ones",
                None,
            );
        }
    }
    vehicle.sides = track_m.map(|track_m| Sides {
        track_m,
        roll_inertia_kg_m2: roll_inertia.unwrap_or(usual),
        pivot_height_m,
    });
}

/// Returns a sea of which nothing is known yet, under a ship of the size of a frigate.
pub(super) fn blank_sea() -> Sea {
    Sea {
        waves: Waves {
            shape: WaveShape::PiersonMoskowitz,
            significant_height_m: f64::NAN,
            peak_period_s: f64::NAN,
            heading_rad: std::f64::consts::PI,
        },
        ship: Ship {
            length_m: f64::NAN,
            beam_m: f64::NAN,
            draught_m: f64::NAN,
            speed_m_s: 0.0,
            roll_period_s: f64::NAN,
            roll_damping: ROLL_DAMPING,
            pivot_m: [0.0; 3],
        },
        traverse: Traverse::default(),
    }
}

/// Damping ratio of roll of a ship with bilge keels (A. Lloyd, Seakeeping: Ship Behaviour in Rough Weather, 1989, ch. 4).
const ROLL_DAMPING: f64 = 0.1;

/// Returns whether a value is still missing, so that the sea cannot be tried.
pub(super) fn is_unread(sea: &Sea) -> bool {
    let (waves, ship) = (&sea.waves, &sea.ship);
    [
        waves.significant_height_m,
        waves.peak_period_s,
        ship.length_m,
        ship.beam_m,
        ship.draught_m,
        ship.roll_period_s,
    ]
    .iter()
    .any(|value| value.is_nan())
}

/// Reads or lists the sea and the ship.
pub(super) fn sea(v: &mut dyn Visit, sea: &mut Sea) {
    let Sea { waves, ship, traverse: ring } = sea;
    choose(
        v,
        &Field::new("waves", "shape of the waves' spectrum").or_text("pierson-moskowitz"),
        &mut waves.shape,
    );
    let height = "significant height of the waves, four times the standard deviation of the surface";
    v.number(
        &Field::new("significant_height", height).unit("m").limit(NumberRange::Between(0.01, 30.0)),
        &mut waves.significant_height_m,
    );
    v.number(
        &Field::new("peak_period", "period of the peak of the waves' spectrum")
            .unit("s")
            .limit(NumberRange::Between(1.0, 40.0)),
        &mut waves.peak_period_s,
    );
    let heading = "from the ship's course to the direction in which the waves go: 0 with the ship, pi against it, pi/2 from its right side";
    v.number(
        &Field::new("heading", heading)
            .unit("rad")
            .limit(NumberRange::Between(-7.0, 7.0))
            .or(std::f64::consts::PI),
        &mut waves.heading_rad,
    );
    let mut positive = |key, meaning, unit, value: &mut f64| {
        v.number(&Field::new(key, meaning).unit(unit).limit(ABOVE_0), value);
    };
    positive("length", "length of the ship's waterline", "m", &mut ship.length_m);
    positive("beam", "beam of the ship", "m", &mut ship.beam_m);
    positive("draught", "draught of the ship", "m", &mut ship.draught_m);
    positive("roll_period", "natural period of the ship's roll", "s", &mut ship.roll_period_s);
    let damping = Field::new("roll_damping", "damping ratio of the ship's roll");
    v.number(&damping.limit(NumberRange::Between(0.01, 1.0)).or(ROLL_DAMPING), &mut ship.roll_damping);
    let speed = Field::new("ship_speed", "speed of the ship").unit("m/s");
    v.number(&speed.limit(NumberRange::Between(0.0, 40.0)).or(0.0), &mut ship.speed_m_s);
    let pivot = "place of the pivot from the middle of the waterline: forward, to the left and up";
    let place = Field::new("pivot", pivot).unit("m").limit(NumberRange::Between(-500.0, 500.0));
    read_three_numbers(v, &place, &mut ship.pivot_m);
    visit_traverse(v, ring);
}
