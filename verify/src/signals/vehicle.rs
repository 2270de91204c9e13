//! A vehicle on two axles, as a road moves it.

/// A vehicle: a body on two axles; half of one if its sides are not stated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vehicle {
    /// Mass of the body, kg.
    pub body_mass_kg: f64,
    /// Pitch inertia of the body about its centre of mass, kg m^2.
    pub pitch_inertia_kg_m2: f64,
    /// Mass of each axle, kg.
    pub axle_mass_kg: f64,
    /// Stiffness of each suspension, N/m.
    pub suspension_n_m: f64,
    /// Damping of each suspension, N s/m.
    pub damping_n_s_m: f64,
    /// Stiffness of each axle's tyres, N/m.
    pub tyre_n_m: f64,
    /// Distance of each axle from the centre of mass, m.
    pub half_base_m: f64,
    /// Distance of the mechanism's pivot in front of the centre of mass, m.
    pub pivot_m: f64,
    /// Two sides, if it has four wheels: it then rolls. `None` if both sides see the same road.
    pub sides: Option<Sides>,
}

impl Vehicle {
    /// A wheeled vehicle of 12 t with heave at about 1.3 Hz and pitch at about 1.5 Hz; chosen, not measured.
    pub const HEAVY: Self = Self {
        body_mass_kg: 12_000.0,
        pitch_inertia_kg_m2: 36_000.0,
        axle_mass_kg: 900.0,
        suspension_n_m: 450_000.0,
        damping_n_s_m: 30_000.0,
        tyre_n_m: 1_800_000.0,
        half_base_m: 2.0,
        pivot_m: 0.5,
        sides: None,
    };
}

/// Parameters of a vehicle with four wheels beside those of [`Vehicle`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sides {
    /// Distance of the left wheels from the right ones, m.
    pub track_m: f64,
    /// Roll inertia of the body, kg m^2.
    pub roll_inertia_kg_m2: f64,
    /// Height of the pivot above the axis about which the body rolls, m.
    pub pivot_height_m: f64,
}
