//! Why something cannot be exported.

/// Every way in which an export can be refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A name that cannot stand in front of every name of the generated code.
    #[error("name '{name}': {problem}")]
    Name {
        /// The name.
        name: String,
        /// Description of the error.
        problem: &'static str,
    },
    /// A number that single precision cannot hold.
    #[error("{what} = {value:e} is out of the range of single precision")]
    SingleRange {
        /// The place of the number.
        what: String,
        /// The number.
        value: f64,
    },
    /// A fixed-point plan of another controller than the one to be exported.
    #[error("the fixed-point plan was made for another controller")]
    OtherController,
    /// A template that could not be filled in.
    #[error("template: {0}")]
    Template(String),
}

impl From<minijinja::Error> for Error {
    fn from(error: minijinja::Error) -> Self {
        Error::Template(error.to_string())
    }
}
