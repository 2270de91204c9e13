//! From a recording to what the model left out.
