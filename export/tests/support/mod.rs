//! Helpers that the tests of generated code share: controllers, a compiler, a program to talk to.
#![allow(dead_code, non_snake_case)]

use std::io::{Read, Write};
use std::path::{Path as FilePath, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use counterpoise_controller::signal::{HUB_POSITION, PLATFORM_SURGE};
use counterpoise_controller::{
    COMMON_READINGS, Controller, Correction, Estimator, FrictionObserver, Learning, LevelLearning, Number,
    ObserverLaw, Parts, Path, PathSignal, Projection, READINGS, Readings, SampledController, Scaling,
};
use counterpoise_export::{File, FixedPointController, FixedRunner, Provenance};
use counterpoise_linalg::Mat;
use counterpoise_lti::{StateSpace, Timebase};

/// Returns a folder for one test, emptied.
pub fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Writes files under a folder.
pub fn write(folder: &FilePath, files: &[File]) {
    for file in files {
        let path = folder.join(&file.name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, &file.text).unwrap();
    }
}

/// Returns whether a program can be started.
pub fn is_there(program: &str) -> bool {
    Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// Says that a test, or a part of it, is skipped, with the tool that is missing. The line goes past the capture of a test's output, so that
/// `.ci/skips` sees it.
pub fn report_skip(why: &str) {
    let _ = writeln!(std::io::stderr(), "skipped: {why}");
}

/// Runs a command; panics with what it printed where it fails. Gives its output.
pub fn run(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let text =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}\n{text}");
    text
}

/// The flags under which generated C must pass without a word.
pub const STRICT: [&str; 10] = [
    "-std=c99",
    "-O1",
    "-Wall",
    "-Wextra",
    "-Wconversion",
    "-Wsign-conversion",
    "-Wdouble-promotion",
    "-Wshadow",
    "-pedantic",
    "-Werror",
];

/// Returns a controller like a design's: feedback with integrator and pairs, heave that scales, pitch, prefilter,
/// friction.
pub fn typical_controller() -> Controller {
    let mut random = RandomGenerator(7);
    let mut parts = Parts::new(1e-3, 10.0);
    parts.design_out_of_balance_kg_m = 151.67;
    parts.out_of_balance_range_kg_m = (-50.0, 300.0);
    parts.bias_v_per_kg_m = 0.019;
    parts.transfer_time_s = 0.05;
    let one = |x: f64| Mat::from_rows(&[&[x]]);
    let timebase = Timebase::Discrete { period_s: 1e-3 };
    let integrator = StateSpace::new(one(1.0), one(0.03), one(1.0), one(9.0), timebase).unwrap();
    let both = counterpoise_lti::parallel(&integrator, &modal(&mut random, 11, 1)).unwrap();
    let mut feedback = path("feedback", vec![PathSignal::RateError], both);
    feedback.anti_windup[0] = 0.02;
    let mut heave = path("heave", vec![PathSignal::PlatformAcceleration], modal(&mut random, 9, 1));
    heave.scaling = Scaling::WithOutOfBalance;
    let pitch = path("pitch", vec![PathSignal::PlatformRate], modal(&mut random, 8, 1));
    parts.paths = vec![feedback, heave, pitch];
    parts.prefilter = Some(modal(&mut random, 1, 1));
    parts.observers = vec![FrictionObserver {
        name: "pivot_friction".into(),
        rate: PathSignal::RelativeRate,
        law: ObserverLaw::Dahl,
        level: Vec::new(),
        coulomb_nm: 117.0,
        rest_stiffness_nm_rad: 2.4e5,
        volts_per_nm: 1e-3,
        viscous_v_s_rad: 0.1,
    }];
    Controller::new(parts).unwrap()
}

/// Returns the controller of [`typical_controller`] with heave and surge projected across the beam by the hub's angle.
pub fn projecting_controller() -> Controller {
    let projection =
        Projection { design_angle_rad: 0.1, angle_reading: Some(HUB_POSITION), pitch_washout_s: Some(10.0) };
    typical_controller().with(|parts| parts.projection = Some(projection)).unwrap()
}

/// Returns every block that a controller can have: besides those of [`typical_controller`], corrected readings, heave and surge projected across the beam, two
/// designs that the out-of-balance fades between, a second observer that follows the demand, a friction level that is learnt, and the estimator of the out-of-balance.
pub fn complete_controller() -> Controller {
    let with = |parts: &mut Parts| {
        parts.projection = projecting_controller().parts().projection;
        parts.corrections = vec![
            Correction { reading: 1, gain: 1.02, offset: -3e-4 },
            Correction { reading: 3, gain: 0.97, offset: 0.012 },
            Correction { reading: 6, gain: 1.01, offset: -0.02 },
        ];
        parts.paths[1].scaling =
            Scaling::Scheduled { below_kg_m: None, at_kg_m: 60.0, above_kg_m: Some(180.0) };
        parts.paths[2].scaling =
            Scaling::Scheduled { below_kg_m: Some(60.0), at_kg_m: 180.0, above_kg_m: None };
        parts.observers.push(FrictionObserver {
            name: "motor_friction".into(),
            rate: PathSignal::Demand,
            law: ObserverLaw::Dahl,
            level: Vec::new(),
            coulomb_nm: 13.0,
            rest_stiffness_nm_rad: 5.2e4,
            volts_per_nm: 2e-3,
            viscous_v_s_rad: 0.0,
        });
        parts.level_learning = Some(LevelLearning {
            lowest: 0.5,
            highest: 1.5,
            cancelled: 0.95,
            gain_per_s: 3.0,
            volts: 0.143,
            sliding_rate_rad_s: 0.01,
            rate_scale_rad_s: 0.05,
        });
        parts.estimator = Some(Estimator {
            gravity_m_s2: 9.80665,
            rate: PathSignal::RelativeRate,
            half_rate_rad_s: 0.01,
            learning: Learning::Gradient { step: 0.3, scale: [0.02, 0.1, 0.1] },
            hold_band_kg_m: 0.0,
            follow_samples: 0,
            hold_samples: 0,
            volts_per_kg_m_s2: 0.019 / 9.80665,
            rate_limit_kg_m_s: 20.0,
        });
    };
    typical_controller().with(with).unwrap()
}

/// Returns a path without anti-windup.
pub fn path(name: &str, inputs: Vec<PathSignal>, system: StateSpace) -> Path {
    let anti_windup = vec![0.0; system.order()];
    Path { name: name.into(), inputs, system, anti_windup, scaling: Scaling::Fixed }
}

/// Returns a stable system of first and second order sections.
pub fn modal(random: &mut RandomGenerator, order: usize, inputs: usize) -> StateSpace {
    let mut A = Mat::zeros(order, order);
    let mut k = 0;
    while k < order {
        let radius = 1.0 - 10.0_f64.powf(-3.0 + 2.5 * random.unit());
        if k + 1 < order && random.unit() < 0.7 {
            let angle = random.unit() * 1.5;
            let (re, im) = (radius * angle.cos(), radius * angle.sin());
            A.set_block(k, k, &Mat::from_rows(&[&[re, im], &[-im, re]]));
            k += 2;
        } else {
            A[(k, k)] = radius;
            k += 1;
        }
    }
    let B = Mat::from_fn(order, inputs, |_, _| 0.1 * random.signed_unit());
    let C = Mat::from_fn(1, order, |_, _| random.signed_unit());
    let D = Mat::from_fn(1, inputs, |_, _| random.signed_unit());
    StateSpace::new(A, B, C, D, Timebase::Discrete { period_s: 1e-3 }).unwrap()
}

/// Returns a full, badly scaled system: a modal one in coordinates that mix its states, in units from 1e-8 to
/// 1e8.
pub fn badly_scaled(random: &mut RandomGenerator, order: usize, inputs: usize) -> StateSpace {
    let base = modal(random, order, inputs);
    let mixed = Mat::from_fn(order, order, |i, j| f64::from(i == j) + 0.05 * random.signed_unit());
    let unit: Vec<f64> = (0..order).map(|_| 10.0_f64.powf(8.0 * random.signed_unit())).collect();
    let T = &mixed * &Mat::diag(&unit);
    let one_over: Vec<f64> = unit.iter().map(|unit| 1.0 / unit).collect();
    let W = &Mat::diag(&one_over) * &counterpoise_linalg::inverse(&mixed).unwrap();
    let A = &(&W * &base.A) * &T;
    StateSpace::new(A, &W * &base.B, &base.C * &T, base.D, base.timebase).unwrap()
}

/// Returns a random controller: of 200 seeds five of each order from 1 to 40, two of them badly scaled.
pub fn random_controller(seed: u64) -> Controller {
    let mut random = RandomGenerator(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    let mut parts = Parts::new(1e-3, 1.0 + 9.0 * random.unit());
    parts.design_out_of_balance_kg_m = 1.0 + 200.0 * random.unit();
    parts.out_of_balance_range_kg_m = (-400.0, 400.0);
    parts.bias_v_per_kg_m = 0.02 * random.signed_unit();
    parts.transfer_time_s = 0.1 * random.unit();
    let order = 1 + seed as usize % 40;
    let signals = [
        PathSignal::RateError,
        PathSignal::PlatformRate,
        PathSignal::PlatformAcceleration,
        PathSignal::MotorRate,
    ];
    let inputs: Vec<PathSignal> = signals[..1 + (random.unit() * 4.0) as usize].to_vec();
    let system = if (seed / 40) % 5 < 2 {
        badly_scaled(&mut random, order, inputs.len())
    } else {
        modal(&mut random, order, inputs.len())
    };
    let mut first = path("first", inputs, system);
    first.anti_windup[0] = 0.1 * random.signed_unit() * first.system.B[(0, 0)];
    let mut second = path("second", vec![PathSignal::HubPosition, PathSignal::PreviousControl], {
        let mut system = modal(&mut random, 2, 2);
        system.D = system.D.scale(0.1);
        system
    });
    second.scaling = match seed % 3 {
        0 => Scaling::Fixed,
        1 => Scaling::WithOutOfBalance,
        _ => Scaling::Scheduled { below_kg_m: Some(0.0), at_kg_m: 90.0, above_kg_m: Some(150.0) },
    };
    parts.paths = vec![first, second];
    Controller::new(parts).unwrap()
}

/// Marsaglia's xorshift generator.
pub struct RandomGenerator(pub u64);

impl RandomGenerator {
    /// Between 0 and 1.
    pub fn unit(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Between -1 and 1.
    pub fn signed_unit(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Returns readings that fill the usual ranges: those of every controller at random, and a surge that follows the heave in the
    /// opposite sense.
    pub fn readings(&mut self) -> [f64; READINGS] {
        let largest = counterpoise_export::vectors::LARGEST;
        let mut readings = [0.0; READINGS];
        (0..COMMON_READINGS).for_each(|i| readings[i] = largest[i] * self.signed_unit());
        readings[PLATFORM_SURGE] = -largest[PLATFORM_SURGE] / largest[3] * readings[3];
        readings
    }
}

/// A program that steps controllers on request: (which, kind, seven doubles) in, one double out.
pub struct Target {
    child: Child,
    to: Option<ChildStdin>,
    from: ChildStdout,
}

/// The request to a target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Request {
    /// Back to the start.
    Reset,
    /// Set the out-of-balance.
    Set(f64),
    /// One sample.
    Step([f64; READINGS]),
}

/// Integers to every plan's own runner and to its C in the program at once: each answer is the same.
pub fn assert_answers(plans: &[FixedPointController], program: &FilePath, asked: &[(usize, Request)]) {
    let answers = Target::start(program).ask_all(asked);
    let mut runners: Vec<FixedRunner> = plans.iter().map(FixedRunner::new).collect();
    for ((which, request), answer) in asked.iter().zip(&answers) {
        match request {
            Request::Set(value) => runners[*which].set_integer(*value as i64),
            Request::Step(v) => {
                assert_eq!(runners[*which].step_integers(&v.map(|x| x as i64)) as f64, *answer)
            }
            Request::Reset => runners[*which].reset(),
        }
    }
    assert_eq!(answers.len(), asked.len());
}

impl Target {
    /// Starts the program.
    pub fn start(program: &FilePath) -> Self {
        Self::launch(&mut Command::new(program))
    }

    /// Starts the program by a command.
    pub fn launch(command: &mut Command) -> Self {
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let (to, from) = (child.stdin.take(), child.stdout.take().unwrap());
        Self { child, to, from }
    }

    /// Carries out a request with controller `which`.
    pub fn ask(&mut self, which: usize, request: Request) -> f64 {
        let to = self.to.as_mut().unwrap();
        to.write_all(&encode(which, request)).unwrap();
        to.flush().unwrap();
        let mut answer = [0; 8];
        self.from.read_exact(&mut answer).unwrap();
        f64::from_ne_bytes(answer)
    }

    /// Carries out many requests at once.
    pub fn ask_all(mut self, requests: &[(usize, Request)]) -> Vec<f64> {
        let bytes: Vec<u8> = requests.iter().flat_map(|(which, request)| encode(*which, *request)).collect();
        let mut to = self.to.take().unwrap();
        let writer = std::thread::spawn(move || to.write_all(&bytes).unwrap());
        let mut answers = Vec::new();
        self.from.read_to_end(&mut answers).unwrap();
        writer.join().unwrap();
        assert!(self.child.wait().unwrap().success());
        answers.chunks_exact(8).map(|chunk| f64::from_ne_bytes(chunk.try_into().unwrap())).collect()
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        self.to = None;
        let _ = self.child.wait();
    }
}

fn encode(which: usize, request: Request) -> Vec<u8> {
    let (kind, values) = match request {
        Request::Reset => (0.0, [0.0; READINGS]),
        Request::Set(value) => (1.0, [value, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
        Request::Step(readings) => (2.0, readings),
    };
    [which as f64, kind].iter().chain(&values).flat_map(|value| value.to_ne_bytes()).collect()
}

/// Returns the main of a [`Target`] in C for controllers with the given names, whose numbers are of type
/// `NAME_real`.
pub fn server(names: &[String]) -> String {
    server_in(names, |name| format!("{name}_real"))
}

/// Returns the main of a [`Target`] in C for controllers whose numbers are of the given type.
pub fn server_in(names: &[String], kind: impl Fn(&str) -> String) -> String {
    let mut text = String::from("#include <stdio.h>\n");
    for name in names {
        let real = kind(name);
        text += &format!("#include \"{name}.h\"\nstatic {name}_state state_{name};\n");
        text += &format!(
            "static double serve_{name}(int kind, const double *v)\n{{\n    if (kind == 0) {{ {name}_reset(&state_{name}); return 0.0; }}\n    if (kind == 1) {{ {name}_set_out_of_balance(&state_{name}, ({real})v[0]); return 0.0; }}\n"
        );
        text +=
            &format!("    {{\n        {name}_readings in;\n        {real} *const each = ({real} *)&in;\n");
        text += &format!(
            "        for (unsigned int i = 0; i < sizeof in / sizeof each[0]; i++) {{ each[i] = ({real})v[i]; }}\n"
        );
        text += &format!("        return (double){name}_step(&state_{name}, &in);\n    }}\n}}\n");
    }
    text += "int main(void)\n{\n    double in[9];\n";
    for name in names {
        text += &format!("    {name}_init(&state_{name});\n");
    }
    text += "    while (fread(in, sizeof in, 1, stdin) == 1) {\n        double out = 0.0;\n        switch ((int)in[0]) {\n";
    for (i, name) in names.iter().enumerate() {
        text += &format!("        case {i}: out = serve_{name}((int)in[1], in + 2); break;\n");
    }
    text += "        default: break;\n        }\n        fwrite(&out, sizeof out, 1, stdout);\n        fflush(stdout);\n    }\n    return 0;\n}\n";
    text
}

/// A target as a controller of the simulated loop.
pub struct InLoop(pub Target);

impl SampledController for InLoop {
    fn reset(&mut self) {
        self.0.ask(0, Request::Reset);
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        self.0.ask(0, Request::Step(readings.to_array()))
    }
}

/// A fixed-point target as a controller of the simulated loop.
pub struct FixedInLoop {
    target: Target,
    fixed: FixedPointController,
}

impl FixedInLoop {
    /// Returns a target that serves the code of this form.
    pub fn new(target: Target, fixed: &FixedPointController) -> Self {
        Self { target, fixed: fixed.clone() }
    }
}

impl SampledController for FixedInLoop {
    fn reset(&mut self) {
        self.target.ask(0, Request::Reset);
    }

    fn step(&mut self, readings: &Readings) -> f64 {
        let (values, bits) = (readings.to_array(), &self.fixed.step.inputs);
        let largest = 2147483647.0;
        let scale = |i: usize| bits.get(i).map_or(0.0, |bits| f64::from(*bits).exp2());
        let integer = |i: usize| (values[i] * scale(i)).round().clamp(-largest, largest);
        let control = self.target.ask(0, Request::Step(std::array::from_fn(integer)));
        control * f64::from(-self.fixed.control_bits()).exp2()
    }
}

/// Returns a provenance.
pub fn provenance() -> Provenance {
    Provenance {
        generator: "counterpoise 0.1.0".into(),
        project: "reference rig".into(),
        project_hash: "0123456789abcdef".into(),
        loop_signals: None,
        weights: vec!["feedback error 1/(s)".into()],
        verdicts: vec!["gain margin >= 12 dB: holds (13.1 dB)".into()],
        feedback_alone: vec!["the linear loop is stable".into()],
        converters: counterpoise_export::Converters::default(),
    }
}

/// Irregular requests: samples, resets, changes of the out-of-balance.
pub fn requests(controllers: usize, samples: usize) -> Vec<(usize, Request)> {
    let mut random = RandomGenerator(99);
    let mut all = Vec::new();
    for k in 0..samples {
        for which in 0..controllers {
            match k % 97 {
                31 => all.push((which, Request::Set(300.0 * random.signed_unit()))),
                77 => all.push((which, Request::Reset)),
                _ => {}
            }
            all.push((which, Request::Step(random.readings().map(|value| f64::from(value as f32)))));
        }
    }
    all
}

/// Returns what the reference answers to the requests.
pub fn reference<N: Number>(controllers: &[Controller], requests: &[(usize, Request)]) -> Vec<f64> {
    let mut runners: Vec<_> = controllers.iter().map(|controller| controller.runner_in::<N>()).collect();
    let mut answer = |(which, request): &(usize, Request)| match request {
        Request::Reset => {
            runners[*which].reset();
            0.0
        }
        Request::Set(value) => {
            runners[*which].set_out_of_balance(*value);
            0.0
        }
        Request::Step(readings) => runners[*which].step_array(readings),
    };
    requests.iter().map(&mut answer).collect()
}

/// Compares bit by bit.
pub fn equal_to_the_last_bit(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    let differs = found.iter().zip(expected).position(|(a, b)| a.to_bits() != b.to_bits());
    assert_eq!(differs, None, "{:?}", differs.map(|i| (found[i], expected[i])));
}
