//! Operations as statements of C and Rust.

use counterpoise_controller::program::{Operation, Program, ProgramTerm, Programs, Slot, StateGroup};

use crate::Precision;
use crate::comment::comment_text;

/// Longest line of generated code.
const WIDTH: usize = 100;

/// A target language.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Dialect {
    /// C99.
    C,
    /// Rust.
    Rust,
}

/// Prints the statements of a program.
pub(crate) struct Printer<'a> {
    /// The language.
    pub dialect: Dialect,
    /// The numbers.
    pub precision: Precision,
    /// The states.
    pub programs: &'a Programs,
    /// The program whose names are used.
    pub program: &'a Program,
    /// Type of a real in the target code.
    pub real: &'a str,
    /// Text before the name of an input: a struct's name and an arrow, or nothing.
    pub input_prefix: &'a str,
}

impl Printer<'_> {
    /// Returns all statements, each section under its comment, and the returned output.
    pub fn body(&self) -> String {
        let mut text = String::new();
        for (i, section) in self.program.sections.iter().enumerate() {
            let gap = if i > 0 { "\n" } else { "" };
            let comment = match self.dialect {
                Dialect::C => format!("{gap}    /* {} */\n", comment_text(&section.says)),
                Dialect::Rust => format!("{gap}        // {}\n", comment_text(&section.says)),
            };
            text.push_str(&comment);
            section.operations.iter().for_each(|operation| text.push_str(&self.statement(operation)));
        }
        if let Some(output) = self.program.output {
            text.push_str(&match self.dialect {
                Dialect::C => format!("\n    return {};\n", self.slot(output)),
                Dialect::Rust => format!("\n        {}\n", self.slot(output)),
            });
        }
        text
    }

    /// Returns a slot as an expression.
    pub fn slot(&self, slot: Slot) -> String {
        match slot {
            Slot::Input(i) => format!("{}{}", self.input_prefix, name(&self.program.inputs, i)),
            Slot::Local(i) => name(&self.program.locals, i).to_owned(),
            Slot::State(i) => state(self.programs, i, self.dialect),
        }
    }

    fn statement(&self, operation: &Operation) -> String {
        let head = self.head(operation.into_slot());
        let indent = if self.dialect == Dialect::C { "    " } else { "        " };
        let pieces = self.pieces(operation);
        wrap(&format!("{indent}{head} = "), &pieces, &format!("{indent}    "))
    }

    fn head(&self, into: Slot) -> String {
        match (into, self.dialect) {
            (Slot::Local(_), Dialect::C) => format!("const {} {}", self.real, self.slot(into)),
            (Slot::Local(_), Dialect::Rust) => format!("let {}", self.slot(into)),
            _ => self.slot(into),
        }
    }

    fn pieces(&self, operation: &Operation) -> Vec<String> {
        match operation {
            Operation::Sum { constant, terms, .. } => self.sum(*constant, terms),
            Operation::Product { a, b, .. } => vec![format!("{} * {}", self.slot(*a), self.slot(*b))],
            Operation::Quotient { above, below, .. } => {
                vec![format!("{} / {}", self.slot(*above), self.slot(*below))]
            }
            Operation::Magnitude { of, .. } => {
                let of = self.slot(*of);
                let zero = self.literal(0.0);
                vec![self.choose(&format!("{of} < {zero}"), &format!("-{of}"), &of)]
            }
            Operation::Clamp { of, low, high, .. } => {
                self.limit(&self.slot(*of), &self.literal(*low), &self.literal(*high))
            }
        }
    }

    /// Itself between the limits, high where above, else low; in pieces between which a line may end.
    fn limit(&self, of: &str, low: &str, high: &str) -> Vec<String> {
        match self.dialect {
            Dialect::C => limit(of, low, high),
            Dialect::Rust => vec![
                format!("if {of} >= {low} {{"),
                format!("if {of} <= {high} {{ {of} }} else {{ {high} }} }}"),
                format!("else {{ {low} }}"),
            ],
        }
    }

    fn choose(&self, condition: &str, yes: &str, no: &str) -> String {
        match self.dialect {
            Dialect::C => format!("(({condition}) ? {yes} : {no})"),
            Dialect::Rust => format!("if {condition} {{ {yes} }} else {{ {no} }}"),
        }
    }

    /// Returns the summands from left to right: a - c b is a + (-c) b, to the last bit.
    fn sum(&self, constant: Option<f64>, terms: &[ProgramTerm]) -> Vec<String> {
        let mut pieces: Vec<String> = constant.map(|c| self.literal(c)).into_iter().collect();
        for term in terms {
            let size = term.coefficient.abs();
            let of = self.slot(term.of);
            let negative = term.coefficient < 0.0;
            let first = pieces.is_empty();
            let sign = if first && negative { "-" } else { "" };
            let product = match (size == 1.0, self.dialect) {
                (true, _) => format!("{sign}{of}"),
                (false, Dialect::C) => format!("({sign}{} * {of})", self.literal(size)),
                (false, Dialect::Rust) => format!("{sign}{} * {of}", self.literal(size)),
            };
            pieces.push(match (first, negative) {
                (true, _) => product,
                (false, false) => format!("+ {product}"),
                (false, true) => format!("- {product}"),
            });
        }
        if pieces.is_empty() { vec![self.literal(0.0)] } else { pieces }
    }

    /// Returns a number as a literal that reads back as exactly this number of the target's precision.
    pub fn literal(&self, value: f64) -> String {
        literal(value, self.precision, self.dialect)
    }
}

/// In C: itself between the limits, high where above, else low, which is also what becomes of a number that is none; in pieces
/// between which a line may end.
pub(crate) fn limit(of: &str, low: &str, high: &str) -> Vec<String> {
    vec![format!("({of} >= {low}) ? (({of} <= {high})"), format!("? {of} : {high})"), format!(": {low}")]
}

/// Returns what a group of states holds, with its unit, for the reader of target code.
pub(crate) fn meaning(group: &StateGroup) -> String {
    let name = group.name.as_str();
    let of = |ending: &str| name.strip_suffix(ending);
    let meaning = match name {
        "out_of_balance_kg_m" => "out-of-balance in force, kg m".to_owned(),
        "bias_v" => "control that holds it, V".to_owned(),
        "transfer_v" => "what is left of the step of the last change, V".to_owned(),
        "previous_control_v" => "limited control of the sample before, V".to_owned(),
        "platform_pitch_rad" => "pitch angle of the platform, rad".to_owned(),
        "prefilter" => "reference prefilter".to_owned(),
        "friction_level" => "level of the friction over that of its observers, learnt".to_owned(),
        "friction_slope" | "friction_offset" => "learnt beside the friction's level".to_owned(),
        "liveliness" => "estimator: mean square of its first regressor, (m/s^2)^2".to_owned(),
        _ if name.starts_with("estimate_") => "estimator: a parameter".to_owned(),
        _ if name.starts_with("variance_") => "estimator: a factor of its covariance".to_owned(),
        _ if name.starts_with("factor_") => "estimator: a factor of its covariance".to_owned(),
        _ if name.starts_with("lagged_") => "estimator: a signal after its lag".to_owned(),
        _ if name.starts_with("window_") => "estimator: of the window that runs".to_owned(),
        _ if name == "estimator_samples" => "estimator: samples so far".to_owned(),
        _ if group.length.is_some() => format!("path {name}"),
        _ => of("_gain")
            .map(|path| format!("gain of path {path} at this out-of-balance"))
            .or(of("_last_v").map(|path| format!("last output of path {path} before its gain, V")))
            .or(of("_nm").map(|observer| format!("torque of friction observer {observer}, N m")))
            .unwrap_or_default(),
    };
    comment_text(&meaning)
}

/// Returns a number as a literal: the shortest decimal that reads back as exactly this number.
pub(crate) fn literal(value: f64, precision: Precision, dialect: Dialect) -> String {
    let digits = match precision {
        Precision::Double => format!("{value:?}"),
        Precision::Single => format!("{:?}", value as f32),
    };
    match (precision, dialect) {
        (Precision::Single, Dialect::C) => format!("{digits}f"),
        _ => digits,
    }
}

/// Returns a state as an expression.
pub(crate) fn state(programs: &Programs, state: usize, dialect: Dialect) -> String {
    let owner = if dialect == Dialect::C { "c->" } else { "self." };
    match programs.locate(state) {
        Some((group, i)) if group.length.is_some() => format!("{owner}{}[{i}]", group.name),
        Some((group, _)) => format!("{owner}{}", group.name),
        None => String::new(),
    }
}

fn name(names: &[String], i: usize) -> &str {
    names.get(i).map_or("", String::as_str)
}

/// Pieces joined by blanks, broken where the line would grow too long.
pub(crate) fn wrap(start: &str, pieces: &[String], indent: &str) -> String {
    let mut text = start.to_owned();
    let mut width = start.len();
    for (i, piece) in pieces.iter().enumerate() {
        if i > 0 && width + piece.len() + 2 > WIDTH {
            text.push('\n');
            text.push_str(indent);
            width = indent.len();
        } else if i > 0 {
            text.push(' ');
            width += 1;
        }
        text.push_str(piece);
        width += piece.len();
    }
    text.push_str(";\n");
    text
}
