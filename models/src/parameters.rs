//! What a mechanism is made of: plain data in SI units, checked when a plant is built from it.
//!
//! Frames and signs: angles are positive nose-up; `out_of_balance` is the first moment of mass about the pivot,
//! positive nose-heavy; gear quantities are at the output (hub) side, motor quantities at the motor shaft.
//! Effects that a plain machine does not have (cogging, springs, mesh ripple, sensor faults) are present as fields
//! whose default value means "absent".

/// One axis of a cantilever mechanism on a moving platform.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Name of the machine.
    pub name: String,
    /// Acceleration of gravity, m/s^2.
    pub gravity_m_s2: f64,
    /// Distributed description of the structure, where it is known.
    pub beam: Option<Beam>,
    /// Two-inertia description of the structure, where it is given; otherwise it is derived from the beam.
    pub lumped: Option<Lumped>,
    /// Gearbox between motor and hub.
    pub gearbox: Gearbox,
    /// Motor.
    pub motor: Motor,
    /// Amplifier that drives the motor.
    pub amplifier: Amplifier,
    /// Friction at the motor shaft (speed relative to the platform).
    pub motor_friction: Friction,
    /// Friction at the hub pivot (rate relative to the platform).
    pub pivot_friction: Friction,
    /// Sensors.
    pub sensors: Sensors,
    /// The digital controller's converters and clock.
    pub interface: Interface,
    /// Ways to load the mechanism: which masses are fitted, what is added.
    pub configurations: Vec<Configuration>,
}

/// The structure as a beam with sections and point masses. x grows towards the tip.
#[derive(Debug, Clone, PartialEq)]
pub struct Beam {
    /// Young's modulus, Pa.
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio; enters only where shear is modelled.
    pub poissons_ratio: f64,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Position of the hub pivot along the beam axis, m.
    pub pivot_m: f64,
    /// Damping ratio of flexible mode 1, 2, ... of the structure pinned at its hub.
    pub modal_damping: Vec<f64>,
    /// What the damping of the structure is made of.
    pub damping: StructuralDamping,
    /// Sections, adjoining, in order of position.
    pub sections: Vec<Section>,
    /// Masses that can be fitted.
    pub masses: Vec<PointMass>,
}

/// What the damping of a structure is made of.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum StructuralDamping {
    /// Damping ratios mode by mode; the last holds for all above: (5-13).
    #[default]
    Modal,
    /// Damping ratios mode by mode; above the last the ratio grows with the frequency, as stiffness damps: (5-14), corrected.
    ModalWithStiffness,
    /// C = a_0 M + a_1 K through two points, each a frequency (rad/s) and its damping ratio: (5-11), (5-12).
    Rayleigh {
        /// Frequency, rad/s, and damping ratio.
        first: [f64; 2],
        /// Frequency, rad/s, and damping ratio.
        second: [f64; 2],
    },
}

/// A stretch of the beam.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Name for reports.
    pub name: String,
    /// Start and end along the axis, m.
    pub from_m: f64,
    /// End along the axis, m.
    pub to_m: f64,
    /// Cross section.
    pub shape: SectionShape,
}

/// The cross section of a stretch of the beam.
#[derive(Debug, Clone, PartialEq)]
pub enum SectionShape {
    /// A tube whose diameters vary linearly from the near to the far end.
    Tube {
        /// Outer diameter at the near and the far end, m.
        outer_diameter_m: [f64; 2],
        /// Inner diameter at the near and the far end, m (0 for solid).
        inner_diameter_m: [f64; 2],
    },
    /// A solid rectangle whose height (in the plane of bending) and width vary linearly from the near to the far end: a wedge, a
    /// tapered bar.
    Rectangle {
        /// Height at the near and the far end, m.
        height_m: [f64; 2],
        /// Width at the near and the far end, m.
        width_m: [f64; 2],
    },
    /// Area and second moment of area given, linear from the near to the far end.
    Given {
        /// Area at the near and the far end, m^2.
        area_m2: [f64; 2],
        /// Second moment of area at the near and the far end, m^4.
        second_moment_m4: [f64; 2],
    },
}

/// A point mass on the beam.
#[derive(Debug, Clone, PartialEq)]
pub struct PointMass {
    /// Name by which a configuration fits it.
    pub name: String,
    /// Position along the axis, m.
    pub position_m: f64,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Own moment of inertia, kg m^2.
    pub inertia_kg_m2: f64,
}

/// The structure as hub and beam inertia joined by a torsional spring.
#[derive(Debug, Clone, PartialEq)]
pub struct Lumped {
    /// Inertia at the hub, kg m^2.
    pub hub_inertia_kg_m2: f64,
    /// Inertia of the beam, kg m^2.
    pub beam_inertia_kg_m2: f64,
    /// Stiffness hub to beam, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Damping hub to beam, N m s/rad.
    pub damping_nm_s_rad: f64,
    /// First moment of mass about the pivot, kg m, positive nose-heavy.
    pub out_of_balance_kg_m: f64,
    /// First moment of mass above the pivot axis, kg m.
    pub vertical_offset_kg_m: f64,
    /// Spring between hub and platform (a cable, a hose), N m/rad; 0 where there is none.
    pub position_stiffness_nm_rad: f64,
    /// Hub angle relative to the platform at which that spring is slack, rad.
    pub position_stiffness_centre_rad: f64,
    /// Largest torque of a hose between hub and platform that remembers how it was bent, N m; 0 where there is none.
    pub hysteresis_nm: f64,
    /// Stiffness of that hose where it springs back, N m/rad.
    pub hysteresis_stiffness_nm_rad: f64,
}

/// A torque that repeats with an angle: amplitude x sin(order x angle + phase).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ripple {
    /// Amplitude in the unit of what it disturbs (N m, or a fraction where it multiplies).
    pub amplitude: f64,
    /// Periods per turn of the angle it follows.
    pub order: f64,
    /// Phase at zero angle, rad.
    pub phase_rad: f64,
}

/// Gearbox between motor and hub; stiffness, damping and backlash at the output.
#[derive(Debug, Clone, PartialEq)]
pub struct Gearbox {
    /// Motor turns per hub turn.
    pub ratio: f64,
    /// Mesh stiffness, N m/rad.
    pub stiffness_nm_rad: f64,
    /// Mesh damping, N m s/rad, only while the teeth touch.
    pub damping_nm_s_rad: f64,
    /// Total gap, rad.
    pub backlash_rad: f64,
    /// Torque on the hub that repeats with the motor angle, N m (amplitude 0: none).
    pub mesh_ripple: Ripple,
    /// Fraction of the mesh torque that reaches the other side while it drives; 1 is ideal.
    pub mesh_efficiency: f64,
}

/// Motor with its electrical circuit.
#[derive(Debug, Clone, PartialEq)]
pub struct Motor {
    /// Inertia of rotor and gearbox input, kg m^2.
    pub inertia_kg_m2: f64,
    /// Torque constant, N m/A.
    pub torque_constant_nm_a: f64,
    /// Back-EMF constant, V s/rad.
    pub back_emf_v_s_rad: f64,
    /// Resistance, ohm.
    pub resistance_ohm: f64,
    /// Inductance, H.
    pub inductance_h: f64,
    /// Torque on the shaft that repeats with the motor angle and does not need current, N m.
    pub cogging: Ripple,
    /// Variation of the torque constant with the motor angle, as a fraction.
    pub torque_ripple: Ripple,
    /// Sense of the rotor's inertial coupling to the platform: J_m (theta_m'' + s theta_p''). 0, +1 or -1.
    pub platform_coupling: f64,
}

/// Amplifier with voltage and current feedback.
#[derive(Debug, Clone, PartialEq)]
pub struct Amplifier {
    /// Voltage gain, V/V.
    pub gain: f64,
    /// Current feedback, V/A.
    pub current_feedback_v_a: f64,
    /// Time constant, s.
    pub time_constant_s: f64,
    /// Input is clipped to +/- this, V.
    pub input_limit_v: f64,
    /// Output is clipped to +/- this, V.
    pub bus_voltage_v: f64,
    /// Measured static map from input voltage to stalled current, odd, by its points with v > 0; empty: linear.
    pub map: Vec<MapPoint>,
    /// Half width of a dead zone at the input, V.
    pub dead_zone_v: f64,
    /// Current is clipped to +/- this, A; infinite where there is no limit.
    pub current_limit_a: f64,
    /// What lies between its input and the motor's current.
    pub dynamics: AmplifierDynamics,
}

/// What lies between an amplifier's input and the motor's current.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AmplifierDynamics {
    /// The amplifier's lag, both feedbacks, the armature and its back-EMF.
    #[default]
    Modelled,
    /// An ideal current source: i = (static gain of the closed amplifier loop) x (input after limit, dead zone and map), whatever
    /// the motor's speed. It follows its input within [`IDEAL_LAG_S`].
    IdealCurrent,
}

/// Time constant with which an ideal current source follows its input, s: a hundredth of the shortest sample period in use.
pub const IDEAL_LAG_S: f64 = 1e-5;

/// A point of the amplifier's measured map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapPoint {
    /// Input voltage, V.
    pub input_v: f64,
    /// Stalled current, A.
    pub current_a: f64,
}

/// Friction between two bodies: a dry part by its law, and a viscous part.
#[derive(Debug, Clone, PartialEq)]
pub struct Friction {
    /// The law of the dry part.
    pub law: FrictionLaw,
    /// Viscous coefficient, N m s/rad.
    pub viscous_nm_s_rad: f64,
    /// Relative growth of the dry level above its Coulomb value at rest: 1 means none (Stribeck).
    pub static_ratio: f64,
    /// Rate at which the Stribeck effect has fallen to 1/e, rad/s.
    pub stribeck_rate_rad_s: f64,
    /// Half the difference of the dry level between the two directions, as a fraction.
    pub asymmetry: f64,
    /// Half the difference of the viscous coefficient between the two directions, as a fraction.
    pub viscous_asymmetry: f64,
    /// Quadratic drag, N m s^2/rad^2.
    pub quadratic_nm_s2_rad2: f64,
    /// Relative variation of the dry level with the angle.
    pub position_ripple: Ripple,
    /// Growth of the dry level per N m of load carried, 1 (N m per N m).
    pub load_coefficient: f64,
    /// Relative change of the friction level as it warms up: level x (1 + warm_up (exp(-t / warm_up_time) - 1)).
    pub warm_up: f64,
    /// Time constant of the warm-up, s.
    pub warm_up_time_s: f64,
}

/// The law of dry friction. Levels in N m, rates in rad/s.
#[derive(Debug, Clone, PartialEq)]
pub enum FrictionLaw {
    /// No dry friction.
    None,
    /// Dahl: dF/dt = sigma w (1 - F/F_c sgn w)^exponent.
    Dahl {
        /// Coulomb level, N m.
        coulomb_nm: f64,
        /// Rest stiffness sigma, N m/rad.
        rest_stiffness_nm_rad: f64,
        /// Exponent; 1 is usual.
        exponent: f64,
    },
    /// LuGre.
    Lugre {
        /// Coulomb level, N m.
        coulomb_nm: f64,
        /// Bristle stiffness, N m/rad.
        bristle_stiffness_nm_rad: f64,
        /// Bristle damping, N m s/rad.
        bristle_damping_nm_s_rad: f64,
    },
    /// Coulomb with true stick (Karnopp); with `static_ratio` above 1 the breakaway level is above the sliding one.
    Coulomb {
        /// Coulomb level, N m.
        coulomb_nm: f64,
    },
    /// Reset integrator (Haessig and Friedland).
    ResetIntegrator {
        /// Sliding level, N m.
        coulomb_nm: f64,
        /// Deflection at which the bond breaks, rad.
        deflection_rad: f64,
        /// Damping of the bond, N m s/rad.
        damping_nm_s_rad: f64,
    },
    /// Sliding level that falls with the rate, with true stick at rest: the Tustin family.
    Stribeck {
        /// Coulomb level, N m.
        coulomb_nm: f64,
        /// How the level falls from `static_ratio` x Coulomb to Coulomb.
        curve: StribeckCurve,
    },
    /// Karnopp: stick inside a band of rates, Coulomb outside; breaks away at `static_ratio` x Coulomb.
    Karnopp {
        /// Coulomb level, N m.
        coulomb_nm: f64,
        /// Half width D_v of the band of rates that counts as rest, rad/s.
        stick_rate_rad_s: f64,
    },
    /// Walrath: T + tau dT/dt = T_c sgn w.
    Walrath {
        /// Coulomb level, N m.
        coulomb_nm: f64,
        /// Time constant tau, s.
        time_constant_s: f64,
        /// Rate at which the smoothed sign has reached tanh 1, rad/s.
        smoothing_rate_rad_s: f64,
    },
    /// Bristles that bend, snap and bond anew (Haessig and Friedland).
    Bristle {
        /// Mean sliding level, N m.
        coulomb_nm: f64,
        /// Number of bristles.
        bristles: usize,
        /// Deflection at which a bond snaps, rad.
        bond_rad: f64,
    },
}

/// How the dry level falls from its static value to its Coulomb value as the rate grows;
/// x is the rate over `stribeck_rate_rad_s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StribeckCurve {
    /// exp(-|x|).
    Tustin,
    /// exp(-x^2).
    Gaussian,
    /// exp(-|x|^exponent).
    Exponential {
        /// Exponent.
        exponent: f64,
    },
    /// 1 / (1 + x^2).
    Lorentzian,
    /// Level over Coulomb is `static_ratio` + c1 x + c2 x^2 + c3 x^3 up to |x| = 1, constant beyond.
    Polynomial {
        /// c1, c2, c3.
        coefficients: [f64; 3],
    },
}

/// The sensors. Each one's reading is gain x truth + bias + g_sensitivity x heave, filtered, delayed, with noise.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensors {
    /// Rate gyroscope on the hub (inertial rate).
    pub hub_gyro: Sensor,
    /// Rate gyroscope on the platform (inertial rate).
    pub platform_gyro: Sensor,
    /// Accelerometer on the platform (heave, gravity removed).
    pub platform_accelerometer: Sensor,
    /// Distance of that accelerometer from the pivot, m: it also reads lever arm x pitch acceleration.
    pub accelerometer_lever_arm_m: f64,
    /// Tachometer on the motor; absent where none is fitted.
    pub motor_tachometer: Option<Sensor>,
    /// Resolver at the hub, relative to the platform; absent where none is fitted.
    pub hub_resolver: Option<Sensor>,
}

/// One sensor with its second-order dynamics.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Natural frequency, rad/s; infinite for an ideal sensor.
    pub natural_frequency_rad_s: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Volts at the converter per unit.
    pub scale_v_unit: f64,
    /// RMS of the white noise at the sample rate, in the measured unit.
    pub noise_rms: f64,
    /// Error of the gain: 1 means none.
    pub gain: f64,
    /// Bias in the measured unit.
    pub bias: f64,
    /// Delay, s (whole samples are what a sampled loop sees).
    pub delay_s: f64,
    /// Reading per m/s^2 of heave, in the measured unit.
    pub g_sensitivity: f64,
}

/// Converters and clock of the digital controller.
#[derive(Debug, Clone, PartialEq)]
pub struct Interface {
    /// Sample period, s.
    pub sample_period_s: f64,
    /// Bits of the analogue-to-digital converters over +/- 10 V.
    pub input_bits: u32,
    /// Bits of the digital-to-analogue converter over +/- 10 V.
    pub output_bits: u32,
    /// Whole samples by which the control is held back.
    pub output_delay_samples: usize,
}

/// A way to load the mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct Configuration {
    /// Name.
    pub name: String,
    /// Names of the beam's masses that are fitted.
    pub masses: Vec<String>,
    /// Inertia added at the hub without moment, kg m^2.
    pub added_hub_inertia_kg_m2: f64,
}

impl Ripple {
    /// No ripple.
    pub const NONE: Self = Self { amplitude: 0.0, order: 1.0, phase_rad: 0.0 };

    /// The ripple at an angle.
    pub fn at(&self, angle_rad: f64) -> f64 {
        if self.amplitude == 0.0 {
            0.0
        } else {
            self.amplitude * (self.order * angle_rad + self.phase_rad).sin()
        }
    }
}

impl Friction {
    /// A Dahl or other law with a viscous part and nothing else.
    pub fn plain(law: FrictionLaw, viscous_nm_s_rad: f64) -> Self {
        Self {
            law,
            viscous_nm_s_rad,
            static_ratio: 1.0,
            stribeck_rate_rad_s: 0.01,
            asymmetry: 0.0,
            viscous_asymmetry: 0.0,
            quadratic_nm_s2_rad2: 0.0,
            position_ripple: Ripple::NONE,
            load_coefficient: 0.0,
            warm_up: 0.0,
            warm_up_time_s: 1.0,
        }
    }

    /// The Coulomb level of the law, N m.
    pub fn coulomb_nm(&self) -> f64 {
        match self.law {
            FrictionLaw::None => 0.0,
            FrictionLaw::Dahl { coulomb_nm, .. }
            | FrictionLaw::Lugre { coulomb_nm, .. }
            | FrictionLaw::Coulomb { coulomb_nm }
            | FrictionLaw::ResetIntegrator { coulomb_nm, .. }
            | FrictionLaw::Stribeck { coulomb_nm, .. }
            | FrictionLaw::Karnopp { coulomb_nm, .. }
            | FrictionLaw::Walrath { coulomb_nm, .. }
            | FrictionLaw::Bristle { coulomb_nm, .. } => coulomb_nm,
        }
    }
}

impl Sensor {
    /// A sensor without dynamics, noise or error, 1 V per unit.
    pub const IDEAL: Self = Self {
        natural_frequency_rad_s: f64::INFINITY,
        damping_ratio: 0.7,
        scale_v_unit: 1.0,
        noise_rms: 0.0,
        gain: 1.0,
        bias: 0.0,
        delay_s: 0.0,
        g_sensitivity: 0.0,
    };
}

impl Parameters {
    /// The parameters with a configuration applied: fitted masses add mass x position^2 to the hub inertia and
    /// mass x position to the out-of-balance (positions relative to the pivot).
    ///
    /// # Errors
    /// The name of a mass that the beam does not have.
    pub fn configured(&self, configuration: &Configuration) -> Result<Self, crate::Error> {
        let mut out = self.clone();
        let Some(lumped) = out.lumped.as_mut() else { return Ok(out) };
        lumped.hub_inertia_kg_m2 += configuration.added_hub_inertia_kg_m2;
        for name in &configuration.masses {
            let (arm, mass) = self.fitted_mass(name, &configuration.name)?;
            lumped.hub_inertia_kg_m2 += mass * arm * arm;
            lumped.out_of_balance_kg_m += mass * arm;
        }
        Ok(out)
    }

    fn fitted_mass(&self, name: &str, configuration: &str) -> Result<(f64, f64), crate::Error> {
        let beam = self.beam.as_ref();
        let found = beam.and_then(|b| {
            b.masses.iter().find(|m| m.name == name).map(|m| (m.position_m - b.pivot_m, m.mass_kg))
        });
        found.ok_or_else(|| crate::Error::UnknownMass {
            mass: name.to_owned(),
            configuration: configuration.to_owned(),
        })
    }
}
