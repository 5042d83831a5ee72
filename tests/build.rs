//! Looks for Embree 3, which the traversal bench compares with where it is installed.

fn main() {
    println!("cargo::rustc-check-cfg=cfg(embree)");
    println!("cargo::rerun-if-changed=/usr/include/embree3/rtcore.h");
    if std::path::Path::new("/usr/include/embree3/rtcore.h").exists() {
        println!("cargo::rustc-cfg=embree");
        println!("cargo::rustc-link-arg-benches=-lembree3");
    }
}
