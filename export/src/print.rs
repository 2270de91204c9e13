//! Operations as statements of C and Rust.

use counterpoise_controller::program::{Operation, Program, Programs, Slot, Term};

use crate::Precision;

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
    /// What stands before the name of an input: a struct's name and an arrow, or nothing.
    pub input_prefix: &'a str,
}

impl Printer<'_> {
    /// All statements, each section under its comment, and the returned output.
    pub fn body(&self) -> String {
        let mut text = String::new();
        for (i, section) in self.program.sections.iter().enumerate() {
            let gap = if i > 0 { "\n" } else { "" };
            let comment = match self.dialect {
                Dialect::C => format!("{gap}    /* {} */\n", section.says),
                Dialect::Rust => format!("{gap}        // {}\n", section.says),
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

    /// A slot as an expression.
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
                let (of, low, high) = (self.slot(*of), self.literal(*low), self.literal(*high));
                let inner = self.choose(&format!("{of} > {high}"), &high, &of);
                vec![self.choose(&format!("{of} < {low}"), &low, &inner)]
            }
        }
    }

    fn choose(&self, condition: &str, yes: &str, no: &str) -> String {
        match self.dialect {
            Dialect::C => format!("(({condition}) ? {yes} : {no})"),
            Dialect::Rust => format!("if {condition} {{ {yes} }} else {{ {no} }}"),
        }
    }

    /// The summands from left to right: a - c b is a + (-c) b, to the last bit.
    fn sum(&self, constant: Option<f64>, terms: &[Term]) -> Vec<String> {
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

    /// A number as a literal that reads back as exactly this number of the target's precision.
    pub fn literal(&self, value: f64) -> String {
        literal(value, self.precision, self.dialect)
    }
}

/// A number as a literal: the shortest decimal that reads back as exactly this number.
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

/// A state as an expression.
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
