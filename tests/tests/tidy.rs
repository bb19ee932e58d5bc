//! Rules about the sources themselves: who may import whom, who may touch files or print, and what every file must have.
//!
//! Each rule is a function over text, so that [`each_rule_can_fail`] can show it a breach of itself.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::Value;

/// Our crates and which of our crates each may depend on, as the first section of the architecture has it.
const EDGES: &[(&str, &[&str])] = &[
    ("shadow-math", &[]),
    ("shadow-scene", &["shadow-math"]),
    ("shadow-cpu", &["shadow-math", "shadow-scene"]),
    ("shadow-gpu", &["shadow-math", "shadow-scene"]),
    ("shadow-cli", &["shadow-math", "shadow-scene", "shadow-cpu", "shadow-gpu"]),
    ("shadow-tests", &["shadow-math", "shadow-scene", "shadow-cpu", "shadow-gpu"]),
];

/// Dependencies that only some crates may have.
const RESERVED: &[(&str, &[&str])] = &[("wgpu", &["shadow-gpu", "shadow-tests"]), ("rayon", &["shadow-cpu"])];

/// The crates that others build on: they neither print nor exit.
const LIBRARIES: &[&str] = &["shadow-math/", "shadow-scene/", "shadow-cpu/", "shadow-gpu/"];

/// Where files may be read or written.
const FILE_ACCESS: &[&str] = &["shadow-scene/src/import", "shadow-cli/", "tests/"];

/// The fuzz targets: a workspace of their own, which inherits nothing from this one.
const FUZZ: &str = "tests/fuzz/";

/// The longest source file, in lines.
const MAX_LINES: usize = 700;

/// A breach of a rule: the file, the line from 1, and what is wrong with it.
#[derive(Debug, PartialEq)]
struct Breach {
    file: String,
    line: usize,
    what: String,
}

impl Breach {
    fn new(file: &str, line: usize, what: impl Into<String>) -> Self {
        Self { file: file.to_string(), line, what: what.into() }
    }
}

/// A source file.
#[derive(Debug)]
struct Source {
    /// The path from the top of the repository, with `/`.
    path: String,
    text: String,
    /// The text with comments and the contents of strings blanked, line for line.
    code: String,
    /// Whether the whole file is compiled for tests only.
    test_only: bool,
}

impl Source {
    fn new(path: &str, text: &str) -> Self {
        Self { path: path.to_string(), text: text.to_string(), code: code_of(text), test_only: false }
    }

    /// The lines of code, from 1, that are not compiled for tests only.
    fn shipped_lines(&self) -> Vec<(usize, String)> {
        if self.test_only {
            return Vec::new();
        }
        numbered(&without_tests(&self.code))
    }
}

fn numbered(text: &str) -> Vec<(usize, String)> {
    text.lines().enumerate().map(|(index, line)| (index + 1, line.to_string())).collect()
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: &str) -> String {
    let full = root().join(path);
    fs::read_to_string(&full).unwrap_or_else(|error| panic!("{}: {error}", full.display()))
}

/// Every file of these extensions in the crates' folders.
fn files(extensions: &[&str]) -> Vec<Source> {
    let mut sources = Vec::new();
    for crate_folder in ["shadow-math", "shadow-scene", "shadow-cpu", "shadow-gpu", "shadow-cli", "tests"] {
        collect(Path::new(crate_folder), extensions, &mut sources);
    }
    assert!(sources.len() > 20, "only {} source files were found", sources.len());
    let test_only: BTreeSet<_> = sources.iter().flat_map(test_modules).collect();
    for source in &mut sources {
        // A module that is for tests only takes the modules in its folder along.
        let is_below = |module: &String| source.path.starts_with(&format!("{}/", module.trim_end_matches(".rs")));
        source.test_only = test_only.contains(&source.path) || test_only.iter().any(is_below);
    }
    sources
}

fn collect(folder: &Path, extensions: &[&str], sources: &mut Vec<Source>) {
    let mut entries: Vec<_> = fs::read_dir(root().join(folder))
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.expect("the folder can be read").file_name())
        .collect();
    entries.sort();
    for name in entries {
        let path = folder.join(&name);
        if root().join(&path).is_dir() {
            if name != "target" {
                collect(&path, extensions, sources);
            }
        } else if path.extension().is_some_and(|extension| extensions.iter().any(|wanted| extension == *wanted)) {
            let path = path.to_string_lossy().replace('\\', "/");
            let text = read(&path);
            sources.push(Source::new(&path, &text));
        }
    }
}

fn rust_sources() -> Vec<Source> {
    files(&["rs"])
}

/// The files under some crate's `src`.
fn rust_in_src() -> Vec<Source> {
    rust_sources().into_iter().filter(|source| source.path.split('/').nth(1) == Some("src")).collect()
}

/// Text with comments and the contents of strings and characters blanked; every line stays where it is.
fn code_of(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let at = |index: usize| chars.get(index).copied().unwrap_or('\0');
    let mut code = String::with_capacity(text.len());
    let mut index = 0;
    while index < chars.len() {
        let begin = index;
        let before = if begin == 0 { '\0' } else { at(begin - 1) };
        match at(index) {
            '/' if at(index + 1) == '/' => {
                while index < chars.len() && at(index) != '\n' {
                    index += 1;
                }
            }
            '/' if at(index + 1) == '*' => {
                let mut depth = 0;
                loop {
                    match (at(index), at(index + 1)) {
                        ('/', '*') => depth += 1,
                        ('*', '/') => depth -= 1,
                        _ => {
                            index += 1;
                            if index >= chars.len() {
                                break;
                            }
                            continue;
                        }
                    }
                    index += 2;
                    if depth == 0 {
                        break;
                    }
                }
            }
            'r' if !is_word(before) || before == 'b' => {
                let mut hashes = 0;
                while at(index + 1 + hashes) == '#' {
                    hashes += 1;
                }
                if at(index + 1 + hashes) == '"' {
                    index += 2 + hashes;
                    while index < chars.len() && !(at(index) == '"' && (1..=hashes).all(|hash| at(index + hash) == '#')) {
                        index += 1;
                    }
                    index += 1 + hashes;
                } else {
                    index += 1;
                    code.push('r');
                    continue;
                }
            }
            '"' => {
                index += 1;
                while index < chars.len() && at(index) != '"' {
                    index += if at(index) == '\\' { 2 } else { 1 };
                }
                index += 1;
            }
            '\'' if at(index + 1) == '\\' => {
                index += 3;
                while index < chars.len() && at(index) != '\'' {
                    index += 1;
                }
                index += 1;
            }
            '\'' if at(index + 2) == '\'' => index += 3,
            other => {
                code.push(other);
                index += 1;
                continue;
            }
        }
        code.extend(chars[begin..index.min(chars.len())].iter().map(|c| if *c == '\n' { '\n' } else { ' ' }));
    }
    code
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Whether the word stands in the text by itself. Only the ends that are letters need a border.
fn has_word(text: &str, word: &str) -> bool {
    text.match_indices(word).any(|(at, _)| {
        let before = text[..at].chars().next_back().is_some_and(is_word);
        let after = text[at + word.len()..].chars().next().is_some_and(is_word);
        !(before && word.starts_with(is_word) || after && word.ends_with(is_word))
    })
}

/// Code with what follows each `#[cfg(test)]` blanked, to the end of its block or statement.
fn without_tests(code: &str) -> String {
    let mut bytes = code.as_bytes().to_vec();
    for (at, attribute) in code.match_indices("#[cfg(test)]") {
        let (mut end, mut depth) = (at + attribute.len(), 0);
        while end < bytes.len() {
            match bytes[end] {
                b'{' => depth += 1,
                b'}' => depth -= 1,
                _ => {}
            }
            end += 1;
            if depth == 0 && matches!(bytes[end - 1], b'}' | b';') {
                break;
            }
        }
        bytes[at..end].iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The paths that modules of this file have that it declares for tests only.
fn test_modules(source: &Source) -> Vec<String> {
    let folder = match source.path.rsplit_once('/') {
        Some((folder, "lib.rs" | "main.rs" | "mod.rs")) => folder.to_string(),
        _ => source.path.trim_end_matches(".rs").to_string(),
    };
    let after = source.code.split("#[cfg(test)]").skip(1);
    let names = after.filter_map(|rest| rest.trim_start().strip_prefix("mod ")?.split_once(';').map(|(name, _)| name));
    names.filter(|name| name.chars().all(is_word)).map(|name| format!("{folder}/{name}.rs")).collect()
}

fn assert_none(breaches: &[Breach]) {
    let lines: Vec<_> = breaches.iter().map(|breach| format!("{}:{}: {}", breach.file, breach.line, breach.what)).collect();
    assert!(lines.is_empty(), "\n{}", lines.join("\n"));
}

fn assert_rule(sources: &[Source], rule: fn(&Source) -> Vec<Breach>) {
    let breaches: Vec<_> = sources.iter().flat_map(rule).collect();
    assert_none(&breaches);
}

/// The lines of code that have one of the words.
fn breaches_of_words(source: &Source, words: &[&str], what: &str) -> Vec<Breach> {
    let mut breaches = Vec::new();
    for (line, code) in source.shipped_lines() {
        for word in words.iter().filter(|word| has_word(&code, word)) {
            breaches.push(Breach::new(&source.path, line, format!("`{word}`: {what}")));
        }
    }
    breaches
}

// Who depends on whom.

fn metadata() -> Value {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps"])
        .current_dir(root())
        .output()
        .expect("cargo can be run");
    assert!(output.status.success(), "cargo metadata: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("cargo metadata is JSON")
}

/// The strings under a key of each element.
fn names<'a>(list: &'a Value, key: &str) -> Vec<&'a str> {
    list.as_array().into_iter().flatten().filter_map(|element| element[key].as_str()).collect()
}

/// Breaches of [`EDGES`] and [`RESERVED`], for dependencies of every kind.
fn wrong_edges(metadata: &Value) -> Vec<Breach> {
    let mut breaches = Vec::new();
    let packages = names(&metadata["packages"], "name");
    for (expected, _) in EDGES.iter().filter(|(name, _)| !packages.contains(name)) {
        breaches.push(Breach::new("Cargo.toml", 1, format!("the crate {expected} is missing")));
    }
    for package in metadata["packages"].as_array().into_iter().flatten() {
        let name = package["name"].as_str().unwrap_or_default();
        let manifest = format!("{name}'s Cargo.toml");
        let Some((_, allowed)) = EDGES.iter().find(|(known, _)| *known == name) else {
            breaches.push(Breach::new(&manifest, 1, "nothing says what this crate may depend on"));
            continue;
        };
        for dependency in names(&package["dependencies"], "name") {
            if EDGES.iter().any(|(ours, _)| *ours == dependency) && !allowed.contains(&dependency) {
                breaches.push(Breach::new(&manifest, 1, format!("{name} must not depend on {dependency}")));
            }
            if RESERVED.iter().any(|(reserved, owners)| *reserved == dependency && !owners.contains(&name)) {
                breaches.push(Breach::new(&manifest, 1, format!("{name} must not depend on {dependency}")));
            }
        }
    }
    breaches
}

#[test]
fn crates_depend_only_on_those_below_them() {
    assert_none(&wrong_edges(&metadata()));
}

/// Each package of a lock file with the packages it depends on, whatever their versions.
fn lock_graph(lock: &str) -> BTreeMap<String, BTreeSet<String>> {
    let mut graph: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for package in lock.split("[[package]]").skip(1) {
        let quoted = |line: &str| line.split('"').nth(1).and_then(|name| name.split(' ').next()).map(String::from);
        let Some(name) = package.lines().find(|line| line.starts_with("name = ")).and_then(quoted) else { continue };
        let dependencies = package.lines().filter(|line| line.starts_with(" \"")).filter_map(quoted);
        graph.entry(name).or_default().extend(dependencies);
    }
    graph
}

/// Whether one package needs another, directly or through others.
fn reaches(graph: &BTreeMap<String, BTreeSet<String>>, from: &str, to: &str) -> bool {
    let (mut seen, mut waiting) = (BTreeSet::new(), vec![from]);
    while let Some(name) = waiting.pop() {
        if name == to {
            return true;
        }
        if seen.insert(name) {
            waiting.extend(graph.get(name).into_iter().flatten().map(String::as_str));
        }
    }
    false
}

/// The same through other people's crates: neither renderer can reach the other or the other's way of working.
#[test]
fn nothing_reaches_the_other_renderer() {
    let graph = lock_graph(&read("Cargo.lock"));
    for (name, allowed) in EDGES {
        assert!(graph.contains_key(*name), "Cargo.lock has no {name}");
        for (other, _) in EDGES.iter().filter(|(other, _)| other != name && !allowed.contains(other)) {
            assert!(!reaches(&graph, name, other), "{name} reaches {other}");
        }
    }
    for name in ["shadow-math", "shadow-scene", "shadow-cpu"] {
        assert!(!reaches(&graph, name, "wgpu"), "{name} reaches wgpu");
    }
    assert!(reaches(&graph, "shadow-gpu", "wgpu") && reaches(&graph, "shadow-cpu", "rayon"), "the lock file was not understood");
}

/// A crate could use wgpu through shadow-gpu, which hands it on.
fn wgpu_outside_its_crates(source: &Source) -> Vec<Breach> {
    if source.path.starts_with("shadow-gpu/") || source.path.starts_with("tests/") {
        return Vec::new();
    }
    breaches_of_words(source, &["wgpu"], "wgpu is used only in shadow-gpu and in the tests")
}

#[test]
fn only_shadow_gpu_uses_wgpu() {
    assert_rule(&rust_sources(), wgpu_outside_its_crates);
}

/// One binary, and its name.
fn wrong_binaries(metadata: &Value) -> Vec<Breach> {
    let mut binaries = Vec::new();
    for package in metadata["packages"].as_array().into_iter().flatten() {
        for target in package["targets"].as_array().into_iter().flatten() {
            if target["kind"].as_array().is_some_and(|kinds| kinds.iter().any(|kind| kind == "bin")) {
                binaries.push(target["name"].as_str().unwrap_or_default().to_string());
            }
        }
    }
    if binaries == ["shadow"] {
        Vec::new()
    } else {
        vec![Breach::new("Cargo.toml", 1, format!("the programs are {binaries:?} and should be `shadow` alone"))]
    }
}

#[test]
fn the_only_program_is_shadow() {
    assert_none(&wrong_binaries(&metadata()));
}

// What sources may do.

/// `shadow-math`'s root has no conditions on `no_std`.
fn no_std_breaches(root: &Source) -> Vec<Breach> {
    if root.code.lines().any(|line| line.trim() == "#![no_std]") {
        Vec::new()
    } else {
        vec![Breach::new(&root.path, 1, "`#![no_std]` is missing or has a condition")]
    }
}

/// A heap, or `std` without the feature.
fn heap_breaches(source: &Source) -> Vec<Breach> {
    let mut breaches = Vec::new();
    let lines: Vec<_> = source.text.lines().collect();
    for (line, code) in source.shipped_lines() {
        if has_word(&code, "extern crate alloc") || has_word(&code, "alloc::") {
            breaches.push(Breach::new(&source.path, line, "shadow-math needs no heap"));
        }
        let under_feature = line >= 2 && lines[line - 2].trim() == "#[cfg(feature = \"std\")]";
        if has_word(&code, "std::") || has_word(&code, "extern crate std") && !under_feature {
            breaches.push(Breach::new(&source.path, line, "shadow-math has `std` only by the feature of that name"));
        }
    }
    breaches
}

#[test]
fn shadow_math_needs_neither_std_nor_a_heap() {
    let sources: Vec<_> = rust_in_src().into_iter().filter(|source| source.path.starts_with("shadow-math/")).collect();
    let root = sources.iter().find(|source| source.path == "shadow-math/src/lib.rs").expect("the crate has a root");
    assert_none(&no_std_breaches(root));
    assert_rule(&sources, heap_breaches);
}

fn file_access(source: &Source) -> Vec<Breach> {
    if FILE_ACCESS.iter().any(|allowed| source.path.starts_with(allowed)) {
        return Vec::new();
    }
    breaches_of_words(source, &["fs", "File::", "OpenOptions"], "files are touched only by the importer and the program")
}

#[test]
fn only_the_importer_and_the_program_touch_files() {
    assert_rule(&rust_sources(), file_access);
}

fn library_noise(source: &Source) -> Vec<Breach> {
    let in_src = source.path.split('/').nth(1) == Some("src");
    if !in_src || !LIBRARIES.iter().any(|library| source.path.starts_with(library)) {
        return Vec::new();
    }
    let words = ["println!", "print!", "eprintln!", "eprint!", "process::exit", "process::abort", "stdout", "stderr"];
    breaches_of_words(source, &words, "a library neither prints nor exits")
}

#[test]
fn libraries_neither_print_nor_exit() {
    assert_rule(&rust_sources(), library_noise);
}

/// `unsafe` without the reason why it is sound within the three lines above it.
fn unexplained_unsafe(source: &Source) -> Vec<Breach> {
    let text: Vec<_> = source.text.lines().collect();
    let explained =
        |line: usize| text[line.saturating_sub(4)..line - 1].iter().any(|above| above.trim_start().starts_with("// SAFETY:"));
    let lines = numbered(&source.code).into_iter().filter(|(line, code)| has_word(code, "unsafe") && !explained(*line));
    lines.map(|(line, _)| Breach::new(&source.path, line, "`unsafe` without a `// SAFETY:` line above it")).collect()
}

#[test]
fn unsafe_code_says_why_it_is_sound() {
    assert_rule(&rust_sources(), unexplained_unsafe);
}

fn no_forbid(root: &Source) -> Vec<Breach> {
    if root.code.lines().any(|line| line.trim() == "#![forbid(unsafe_code)]") {
        Vec::new()
    } else {
        vec![Breach::new(&root.path, 1, "`#![forbid(unsafe_code)]` is missing")]
    }
}

#[test]
fn most_crates_forbid_unsafe_code() {
    let roots = ["shadow-math/src/lib.rs", "shadow-scene/src/lib.rs", "shadow-gpu/src/lib.rs", "shadow-cli/src/main.rs"];
    let breaches: Vec<_> = roots.into_iter().flat_map(|path| no_forbid(&Source::new(path, &read(path)))).collect();
    assert_none(&breaches);
}

// What every file must have.

fn no_module_doc(source: &Source) -> Vec<Breach> {
    if source.text.starts_with("//! ") {
        Vec::new()
    } else {
        vec![Breach::new(&source.path, 1, "the file does not begin with a `//!` line that says what it is")]
    }
}

#[test]
fn every_file_says_what_it_is() {
    let mut sources = rust_in_src();
    let has_folder = |source: &Source| source.path.starts_with("tests/tests/") || source.path.starts_with(FUZZ);
    sources.extend(rust_sources().into_iter().filter(has_folder));
    assert_rule(&sources, no_module_doc);
}

/// Attributes that allow or expect a lint, and give no reason.
fn unreasoned_attributes(source: &Source) -> Vec<Breach> {
    let mut breaches = Vec::new();
    for opening in ["#[", "#!["] {
        for (at, _) in source.code.match_indices(opening) {
            let mut depth = 0;
            let end = source.code[at..].find(|c| {
                depth += i32::from(c == '[') - i32::from(c == ']');
                c == ']' && depth == 0
            });
            let attribute = &source.code[at..at + end.unwrap_or(0)];
            if (has_word(attribute, "allow(") || has_word(attribute, "expect(")) && !has_word(attribute, "reason") {
                let line = source.code[..at].matches('\n').count() + 1;
                breaches.push(Breach::new(&source.path, line, "a lint is switched off without a reason"));
            }
        }
    }
    breaches
}

#[test]
fn switched_off_lints_have_a_reason() {
    assert_rule(&rust_sources(), unreasoned_attributes);
}

/// Notes to oneself, in code or comments of any source.
fn notes_to_oneself(source: &Source) -> Vec<Breach> {
    // Put together, so that this file does not breach its own rule.
    let notes =
        [concat!("TO", "DO"), concat!("FIX", "ME"), concat!("to", "do!"), concat!("unimplem", "ented!"), concat!("db", "g!")];
    let mut breaches = Vec::new();
    for (line, text) in numbered(&source.text) {
        for note in notes.iter().filter(|note| has_word(&text, note)) {
            breaches.push(Breach::new(&source.path, line, format!("`{note}` is left in the sources")));
        }
    }
    breaches
}

#[test]
fn nothing_is_left_to_be_done() {
    assert_rule(&files(&["rs", "wgsl", "toml"]), notes_to_oneself);
}

fn too_long(source: &Source) -> Vec<Breach> {
    let lines = source.text.lines().count();
    if lines > MAX_LINES {
        vec![Breach::new(&source.path, lines, format!("{lines} lines; a file has at most {MAX_LINES}"))]
    } else {
        Vec::new()
    }
}

#[test]
fn no_file_is_too_long() {
    assert_rule(&rust_in_src(), too_long);
}

// What the crates share.

/// The keys that a crate takes from the workspace and this one does not.
fn not_inherited(manifest: &Source) -> Vec<Breach> {
    let mut breaches = Vec::new();
    for key in ["version", "edition", "rust-version", "license"] {
        if !manifest.text.lines().any(|line| line.trim() == format!("{key}.workspace = true")) {
            breaches.push(Breach::new(&manifest.path, 1, format!("`{key}.workspace = true` is missing")));
        }
    }
    let mut lints = manifest.text.split("\n[lints]\n").skip(1);
    if !lints.next().is_some_and(|rest| rest.trim_start().starts_with("workspace = true")) {
        breaches.push(Breach::new(&manifest.path, 1, "`[lints]` does not say `workspace = true`"));
    }
    breaches
}

#[test]
fn crates_inherit_what_they_share() {
    let is_inside = |source: &Source| source.path.ends_with("/Cargo.toml") && !source.path.starts_with(FUZZ);
    let manifests: Vec<_> = files(&["rs", "toml"]).into_iter().filter(is_inside).collect();
    assert_eq!(manifests.len(), EDGES.len(), "every crate has a manifest");
    assert_rule(&manifests, not_inherited);
}

/// Fuzz targets need a compiler and flags that the other crates do without: whoever builds the workspace does not build them.
#[test]
fn fuzz_targets_are_a_workspace_of_their_own() {
    let manifest = read(&format!("{FUZZ}Cargo.toml"));
    assert!(manifest.lines().any(|line| line == "[workspace]"), "{FUZZ}Cargo.toml is no workspace");
    assert!(!names(&metadata()["packages"], "name").contains(&"shadow-fuzz"), "the workspace has the fuzz targets");
}

/// Every version of Rust that the README names is the workspace's, and it names it.
fn readme_versions(readme: &str, manifest: &str) -> Vec<Breach> {
    let wanted = manifest.lines().find_map(|line| line.strip_prefix("rust-version = \"")?.strip_suffix('"'));
    let Some(wanted) = wanted else { return vec![Breach::new("Cargo.toml", 1, "`rust-version` is missing")] };
    let mut breaches = Vec::new();
    let mut named = false;
    for (line, text) in numbered(readme) {
        for rest in text.split("Rust 1.").skip(1) {
            let version = format!("1.{}", rest.chars().take_while(char::is_ascii_digit).collect::<String>());
            named = true;
            if version != wanted {
                breaches.push(Breach::new("README.md", line, format!("Rust {version} is named, and Cargo.toml says {wanted}")));
            }
        }
    }
    if !named {
        breaches.push(Breach::new("README.md", 1, format!("`Rust {wanted}`, the oldest that works, is not named")));
    }
    breaches
}

#[test]
fn the_readme_names_the_oldest_rust() {
    assert_none(&readme_versions(&read("README.md"), &read("Cargo.toml")));
}

#[test]
fn both_licences_are_there() {
    for (file, words) in [("LICENSE-MIT", "Permission is hereby granted"), ("LICENSE-APACHE", "Apache License")] {
        assert!(read(file).contains(words), "{file} is not that licence");
    }
    let said = read("Cargo.toml").lines().any(|line| line == "license = \"MIT OR Apache-2.0\"");
    assert!(said, "Cargo.toml does not name both licences");
}

// The rules themselves.

/// Each rule sees a breach of itself, and passes what only looks like one.
#[test]
fn each_rule_can_fail() {
    type Rule = fn(&Source) -> Vec<Breach>;
    let unreasoned = "//! A.\n#[allow(dead_code)]\nfn a() {}";
    let manifest = "[package]\nversion.workspace = true\nedition.workspace = true\nrust-version.workspace = true\n\
        license.workspace = true\n\n[lints]\nworkspace = true\n";
    let long = "\n".repeat(MAX_LINES + 1);
    let note = format!("// {}: finish", concat!("TO", "DO"));
    // The rule, a path, what breaches it and in which line, and what does not.
    let cases: &[(Rule, &str, &str, usize, &str)] = &[
        (wgpu_outside_its_crates, "shadow-cli/src/main.rs", "use shadow_gpu::wgpu;", 1, "// wgpu\nlet x = \"wgpu\";"),
        (no_std_breaches, "shadow-math/src/lib.rs", "#![cfg_attr(not(feature = \"std\"), no_std)]", 1, "#![no_std]"),
        (
            heap_breaches,
            "shadow-math/src/lib.rs",
            "#![no_std]\nextern crate alloc;",
            2,
            "#[cfg(feature = \"std\")]\nextern crate std;",
        ),
        (heap_breaches, "shadow-math/src/a.rs", "\n\nextern crate std;", 3, "#[cfg(test)]\nmod tests { use std::vec; }"),
        (file_access, "shadow-cpu/src/a.rs", "use std::{env, fs};", 1, "let offset = 3; // std::fs"),
        (file_access, "shadow-cpu/src/a.rs", "\nlet x = File::open(y);", 2, "let x = ShaderFile::new();"),
        (file_access, "shadow-gpu/src/a.rs", "OpenOptions::new()", 1, "\"OpenOptions\""),
        (
            library_noise,
            "shadow-cpu/src/a.rs",
            "fn a() {\n    println!(\"a\");\n}",
            2,
            "#[cfg(test)]\nmod tests { fn a() { println!(\"a\"); } }",
        ),
        (
            library_noise,
            "shadow-scene/src/a.rs",
            "std::process::exit(1)",
            1,
            "/// Call `std::process::exit(1)`.\n/* println!() */",
        ),
        (
            unexplained_unsafe,
            "shadow-cpu/src/a.rs",
            "// SAFETY: far\n\n\n\nunsafe { a() }",
            5,
            "// SAFETY: it is.\n#[allow(x)]\nunsafe { a() }",
        ),
        (no_forbid, "shadow-math/src/lib.rs", "//! #![forbid(unsafe_code)]", 1, "#![forbid(unsafe_code)]"),
        (no_module_doc, "shadow-cpu/src/a.rs", "// A.\nuse b;", 1, "//! A.\nuse b;"),
        (unreasoned_attributes, "shadow-cpu/src/a.rs", unreasoned, 2, "#[allow(dead_code, reason = \"a\")]\nx.expect(\"b\");"),
        (unreasoned_attributes, "shadow-cpu/src/a.rs", "#![cfg_attr(a, expect(b))]", 1, "#[test]\nfn allow() { expect(a) }"),
        (notes_to_oneself, "shadow-cpu/src/a.rs", &note, 1, "let TODOS = 3;"),
        (too_long, "shadow-cpu/src/a.rs", &long, MAX_LINES + 1, "\n"),
        (not_inherited, "shadow-cpu/Cargo.toml", "[package]\nversion.workspace = true", 1, manifest),
    ];
    for (rule, path, wrong, line, right) in cases {
        let breaches = rule(&Source::new(path, wrong));
        assert!(breaches.first().is_some_and(|breach| breach.line == *line), "{wrong:?} gives {breaches:?}");
        let breaches = rule(&Source::new(path, right));
        assert!(breaches.is_empty(), "{right:?} gives {breaches:?}");
    }
    for key in ["edition", "rust-version", "license", "[lints]"] {
        let lacking: Vec<_> = manifest.lines().filter(|line| !line.starts_with(key)).collect();
        assert_eq!(not_inherited(&Source::new("Cargo.toml", &lacking.join("\n"))).len(), 1, "a manifest without {key}");
    }
}

#[test]
fn rules_over_dependencies_can_fail() {
    let package = |name: &str, dependencies: &[&str]| {
        let dependencies: Vec<_> = dependencies.iter().map(|name| serde_json::json!({ "name": name })).collect();
        serde_json::json!({ "name": name, "dependencies": dependencies, "targets": [] })
    };
    let workspace = |changed: &str, dependencies: &[&str]| {
        let packages: Vec<_> =
            EDGES.iter().map(|(name, allowed)| package(name, if *name == changed { dependencies } else { allowed })).collect();
        serde_json::json!({ "packages": packages })
    };
    assert_eq!(wrong_edges(&workspace("", &[])), []);
    let wrong = [
        ("shadow-cpu", "shadow-gpu"),
        ("shadow-gpu", "shadow-cpu"),
        ("shadow-math", "shadow-scene"),
        ("shadow-cli", "wgpu"),
        ("shadow-gpu", "rayon"),
        ("shadow-scene", "rayon"),
    ];
    for (name, dependency) in wrong {
        assert_eq!(wrong_edges(&workspace(name, &[dependency])).len(), 1, "{name} on {dependency}");
    }
    let mut more = workspace("", &[]);
    more["packages"].as_array_mut().expect("it is a list").push(package("shadow-more", &[]));
    assert_eq!(wrong_edges(&more).len(), 1, "an unknown crate");

    let program = |name: &str| serde_json::json!({ "targets": [{ "name": name, "kind": ["bin"] }] });
    assert_eq!(wrong_binaries(&serde_json::json!({ "packages": [program("shadow")] })), []);
    for packages in [vec![], vec![program("other")], vec![program("shadow"), program("other")]] {
        assert_eq!(wrong_binaries(&serde_json::json!({ "packages": packages })).len(), 1);
    }

    let lock = "[[package]]\nname = \"a\"\ndependencies = [\n \"b 1.0.0\",\n]\n\n\
        [[package]]\nname = \"b\"\ndependencies = [\n \"c\",\n]\n\n[[package]]\nname = \"c\"\n";
    let graph = lock_graph(lock);
    assert!(reaches(&graph, "a", "c") && !reaches(&graph, "c", "a"));
}

#[test]
fn rules_over_the_readme_can_fail() {
    let manifest = "[workspace.package]\nrust-version = \"1.88\"\n";
    assert_eq!(readme_versions("It needs Rust 1.88 or later.", manifest), []);
    assert_eq!(readme_versions("It needs Rust.", manifest).len(), 1);
    assert_eq!(readme_versions("Rust 1.88.\nRust 1.89.", manifest)[0].line, 2);
    assert_eq!(readme_versions("Rust 1.88", "").len(), 1);
}

/// What the rules look at: code without comments, strings and tests, each line where it was.
#[test]
fn comments_strings_and_tests_are_not_code() {
    let cases = [
        ("a // b\nc", "a     \nc"),
        ("a /* b /* c */\n d */ e", "a             \n      e"),
        ("a(\"b \\\" // c\") d", "a(           ) d"),
        ("r#\"a \" b\"# c", "           c"),
        ("'a' + b'\\'' + '\\u{1}' <'a>", "    + b     + '\\u{1}' <'a>"),
        ("error(r) + br\"a\"", "error(r) + b    "),
    ];
    for (text, expected) in cases {
        // Characters may be blanked whole or in part; words in them do not matter.
        let code = code_of(text);
        assert_eq!(code.len(), text.len(), "{text:?} became {code:?}");
        assert_eq!(code.replace("'\\u{1}'", "       "), expected.replace("'\\u{1}'", "       "), "{text:?}");
    }
    let code = "a;\n#[cfg(test)]\nmod tests {\n  b { c }\n}\nd;";
    assert_eq!(without_tests(code).split_whitespace().collect::<Vec<_>>(), ["a;", "d;"]);
    assert_eq!(without_tests(code).lines().count(), code.lines().count());
    let declares = |path: &str| test_modules(&Source::new(path, "#[cfg(test)]\nmod tests;\nmod other;"));
    assert_eq!(declares("a/src/import.rs"), ["a/src/import/tests.rs"]);
    assert_eq!(declares("a/src/lib.rs"), ["a/src/tests.rs"]);
}
