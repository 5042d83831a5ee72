//! Bytes as a blob.

use super::estimates;
use etendue::Scene;
use etendue_host::blob::AlignedBlob;

/// **Property:** any bytes at all are refused with a reason, or are a scene of which every estimator makes finite
/// light ≥ 0 in bounded steps, with the same bits on every instruction set.
pub fn blob(bytes: &[u8]) {
    let aligned = AlignedBlob::copy_of(bytes);
    match Scene::open(aligned.bytes()) {
        Ok(scene) => estimates(&scene, bytes.len() as u64),
        Err(e) => assert!(!e.to_string().is_empty()),
    }
}
