//! Malformed and odd files: each is refused in one line, or loads for a reason that is written down.
//!
//! `malformed.txt` is the table. All files are imported by one child process that has little memory, so that a file which
//! asks for more than it has bytes for ends the child.

use std::{
    collections::BTreeMap,
    env,
    path::PathBuf,
    process::Command,
    time::{Duration, Instant},
};

use shadow_scene::import;
use shadow_tests::renderers::{scene_files, scenes};

/// What the child may take, in KiB: 512 MiB of addresses, its own program included.
const MEMORY_KIB: u32 = 512 * 1024;

/// The longest that a file may take. It is far above what any takes, and far below a loop that a count in a file drives.
const MAX_TIME: Duration = Duration::from_secs(2);

/// The test that is the child, and what tells it that it is.
const CHILD: &str = "malformed::child_that_imports_every_file";
const FOLDER: &str = "SHADOW_TESTS_MALFORMED";

/// The table: whether a file loads, and if so, why.
fn table() -> BTreeMap<String, Option<String>> {
    let line = |line: &str| {
        let mut columns = line.splitn(3, " | ");
        let verdict = columns.next().unwrap_or_default();
        let file = columns.next().unwrap_or_else(|| panic!("`{line}` names no file")).to_string();
        match (verdict, columns.next()) {
            ("loads", Some(reason)) if !reason.is_empty() => (file, Some(reason.to_string())),
            ("refused", None) => (file, None),
            _ => panic!("`{line}` is neither `refused | file` nor `loads | file | reason`"),
        }
    };
    include_str!("malformed.txt").lines().filter(|line| !line.starts_with('#')).map(line).collect()
}

#[test]
fn every_malformed_file_ends_as_the_table_says() {
    let Some(folder) = scenes("every_malformed_file_ends_as_the_table_says") else { return };
    let folder = folder.join("invalid");
    let table = table();
    let files = scene_files(&folder);
    let unlisted: Vec<_> = files.iter().filter(|file| !table.contains_key(*file)).collect();
    let missing: Vec<_> = table.keys().filter(|file| !files.contains(file)).collect();
    assert!(unlisted.is_empty() && missing.is_empty(), "not in the table: {unlisted:?}; not in the folder: {missing:?}");

    let program = env::current_exe().expect("the tests know where they are");
    let arguments = [CHILD, "--exact", "--ignored", "--nocapture", "--test-threads=1"];
    let mut child = if cfg!(unix) {
        let mut shell = Command::new("sh");
        shell.arg("-c").arg(format!("ulimit -v {MEMORY_KIB} && exec \"$0\" \"$@\"")).arg(program);
        shell
    } else {
        Command::new(program)
    };
    let output = child.args(arguments).env(FOLDER, &folder).output().expect("the child starts");
    let (stdout, stderr) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    let last = stdout.lines().last().unwrap_or_default();
    assert!(output.status.success(), "the child ended with {} after `{last}`: {stderr}", output.status);

    // Tabs, because messages may have anything else in them but line breaks.
    let results: Vec<Vec<&str>> =
        stdout.lines().map(|line| line.split('\t').collect()).filter(|l: &Vec<_>| l.len() == 3).collect();
    assert_eq!(results.len(), files.len(), "a line for each file: a message with a line break would make more");
    let mut wrong = Vec::new();
    for result in results {
        let [verdict, file, message] = result[..] else { unreachable!("the lines have three columns") };
        let expected = if table[file].is_some() { "loads" } else { "refused" };
        if verdict != expected {
            wrong.push(format!("{file}: {verdict}, but the table says {expected}: {message}"));
        }
        if verdict == "refused" && !message.starts_with(&folder.join(file).display().to_string()) {
            wrong.push(format!("{file}: the error does not begin with the file: {message}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The child of the test above: it says of each file how its import ends.
#[test]
#[ignore = "another test runs it, in a process with little memory"]
#[allow(clippy::print_stdout, reason = "its output is what the parent reads")]
fn child_that_imports_every_file() {
    let Some(folder) = env::var_os(FOLDER).map(PathBuf::from) else { return };
    println!();
    for file in scene_files(&folder) {
        println!("{file}");
        let start = Instant::now();
        let result = import(&folder.join(&file));
        let time = start.elapsed();
        assert!(time < MAX_TIME, "{file} takes {time:?}");
        match result {
            Ok(scene) => {
                let vertices = scene.vertices();
                let is_finite = vertices.positions.iter().chain(&vertices.normals).all(|vector| vector.is_finite())
                    && vertices.uvs.iter().all(|uv| uv.is_finite())
                    && vertices.colors.iter().all(|color| color.is_finite());
                assert!(is_finite, "{file} has numbers that are not finite");
                println!("loads\t{file}\t");
            }
            Err(error) => println!("refused\t{file}\t{error}"),
        }
    }
}
