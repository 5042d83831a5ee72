//! Shared helpers of the truth, agreement and golden tests.
