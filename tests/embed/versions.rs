//! Packages outside of the workspace use what the workspace's table says.

use etendue_tests::place::root;
use std::collections::BTreeMap;

/// The resolved versions in a lock file, by package.
fn locked(folder: &str) -> BTreeMap<String, Vec<String>> {
    let file = root().join(folder).join("Cargo.lock");
    let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let mut versions: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for package in text.split("[[package]]").skip(1) {
        let field = |name: &str| {
            let prefix = format!("{name} = \"");
            let line = package.lines().find(|l| l.starts_with(&prefix)).unwrap();
            line[prefix.len()..].trim_end_matches('"').to_owned()
        };
        versions
            .entry(field("name"))
            .or_default()
            .push(field("version"));
    }
    versions
}

/// Every package of that kind, and the kernel's dependencies.
#[test]
fn lock_files_agree_on_the_kernels_dependencies() {
    let workspace = locked(".");
    let names = [
        "glam",
        "libm",
        "rand_core",
        "rand_pcg",
        "heapless",
        "bytemuck",
    ];
    for package in [
        "kernel/capi",
        "kernel/ptx",
        "kernel/examples/cortex-m",
        "kernel/examples/web",
        "fuzz",
    ] {
        let own = locked(package);
        for name in names {
            assert_eq!(own.get(name), workspace.get(name), "{package}: {name}");
        }
    }
}
