//! H2 feedback and feedforward by Riccati and Sylvester equations.
