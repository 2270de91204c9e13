//! Counterpoise: a control-design studio for stabilised, out-of-balance servo mechanisms.
fn main() {}
