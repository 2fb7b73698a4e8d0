//! Files whole or not at all, and what is told before.

use std::fs::{File, Permissions};

use super::temporary::name as temporary_name;
use super::*;

fn names(folder: &Path) -> Vec<OsString> {
    let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    names
}

fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    write_atomically(path, |out| out.write_all(bytes).map_err(|e| write_error(&e)))
}

#[test]
fn a_failure_keeps_the_old_file_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.png");
    write(&path, b"old").unwrap();
    let error = write_atomically(&path, |out| {
        out.write_all(&[0; 100_000]).unwrap();
        Err(Error::new("no"))
    });
    assert_eq!(error, Err(Error::file(&path, "no")));
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["out.png"]);
    write(&path, b"new").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(names(folder.path()), ["out.png"]);
}

#[test]
fn a_panic_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.png");
    let caught = std::panic::catch_unwind(|| write_atomically(&path, |_| panic!("expected")));
    assert!(caught.is_err());
    assert!(names(folder.path()).is_empty());
}

#[test]
fn checking_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.png");
    check_writable(&Destination::File(path.clone())).unwrap();
    assert!(names(folder.path()).is_empty());
    fs::write(&path, b"old").unwrap();
    check_writable(&Destination::File(path.clone())).unwrap();
    assert_eq!(names(folder.path()), ["out.png"]);
    assert_eq!(fs::read(&path).unwrap(), b"old");
}

#[test]
fn bad_places_are_refused_early_and_late() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), b"").unwrap();
    for (name, fault) in [
        ("", "is a directory"),
        ("missing/out.png", "does not exist"),
        ("missing/", "is a directory"),
        ("file/out.png", "does not exist"),
        (&"x".repeat(300), "too long"),
    ] {
        let path = folder.path().join(name);
        for result in [check_writable(&path.as_path().into()), write(&path, b"bytes")] {
            let error = result.expect_err(name);
            assert_eq!(error.file.as_deref(), Some(path.as_path()));
            assert!(error.message.contains(fault), "{error}");
        }
    }
    assert!(write(Path::new(""), b"").is_err());
    assert_eq!(names(folder.path()), ["file"]);
}

#[test]
fn a_dash_is_standard_output() {
    assert_eq!(Destination::from(Path::new("-")), Destination::Stdout);
    let file = Destination::from(OsString::from("./-"));
    assert_eq!(file, Destination::File("./-".into()));
    assert_eq!(Destination::Stdout.format(), Ok(Format::Png));
    assert!(file.format().is_err());
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_permissions_kept() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let (file, link) = (folder.path().join("file"), folder.path().join("link"));
    fs::write(&file, b"old").unwrap();
    fs::set_permissions(&file, Permissions::from_mode(0o640)).unwrap();
    symlink("file", &link).unwrap();
    write(&link, b"new").unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read(&file).unwrap(), b"new");
    assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
}

#[cfg(unix)]
#[test]
fn a_fifo_is_checked_without_waiting_and_never_read_as_an_image() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fifo.png");
    let made = std::process::Command::new("mkfifo").arg(&path).status();
    assert!(made.unwrap().success());
    check_writable(&path.as_path().into()).unwrap();
    assert!(eyerays::image::read(&path).is_err());
    std::thread::scope(|scope| {
        scope.spawn(|| write(&path, b"bytes").unwrap());
        assert_eq!(fs::read(&path).unwrap(), b"bytes");
    });
    assert_eq!(names(folder.path()), ["fifo.png"]);
}

#[cfg(target_os = "linux")]
#[test]
fn devices_are_written_straight_to() {
    let full = Path::new("/dev/full");
    check_writable(&full.into()).unwrap();
    let error = write(full, b"bytes").unwrap_err();
    assert_eq!(error.to_string(), "/dev/full: no space left; free some or write elsewhere");
    write(Path::new("/dev/null"), b"bytes").unwrap();
    assert!(!fs::metadata("/dev/null").unwrap().is_file());
    assert_eq!(Destination::from(full).format(), Ok(Format::Png));
}

#[test]
fn what_a_killed_process_left_is_removed_and_what_a_living_one_writes_stays() {
    let folder = tempfile::tempdir().unwrap();
    let [stale, living] = [1, 2].map(|count| folder.path().join(temporary_name(1, count)));
    let others = [".eyerays-1.tmp", ".eyerays-a-1.tmp", ".eyerays-1-1.tmp.png", "eyerays-1-1.tmp"];
    fs::write(&stale, b"half").unwrap();
    let writer = File::create(&living).unwrap();
    writer.lock().unwrap();
    for name in others {
        fs::write(folder.path().join(name), b"not ours").unwrap();
    }
    write(&folder.path().join("out.png"), b"new").unwrap();
    let kept = temporary_name(1, 2);
    let mut left = [&others[..], &["out.png", &kept]].concat();
    left.sort();
    assert_eq!(names(folder.path()), left);
    drop(writer);
    check_writable(&folder.path().join("out.png").as_path().into()).unwrap();
    assert!(!living.exists());
}

#[test]
fn processes_that_clear_a_folder_take_no_file_that_another_writes() {
    let folder = tempfile::tempdir().unwrap();
    std::thread::scope(|scope| {
        for thread in 0..8 {
            let path = folder.path().join(format!("{thread}.png"));
            scope.spawn(move || (0..200).for_each(|_| write(&path, b"bytes").unwrap()));
        }
    });
    assert_eq!(names(folder.path()).len(), 8);
}

#[test]
fn an_output_is_no_input_and_no_other_output_however_it_is_spelled() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let file = |name: &str| Destination::File(at(name));
    fs::create_dir(at("sub")).unwrap();
    fs::write(at("in.png"), b"in").unwrap();
    fs::hard_link(at("in.png"), at("hard.png")).unwrap();
    let mut names = vec!["in.png", "./in.png", "sub/../in.png", "hard.png"];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("in.png", at("soft.png")).unwrap();
        names.push("soft.png");
    }
    for name in names {
        let error = check_apart(&[file("new.png"), file(name)], [at("other.png"), at("in.png")]).unwrap_err();
        assert_eq!(error.file, Some(at(name)));
        assert!(error.message.starts_with("would replace the input") && error.message.contains("in.png"), "{error}");
        assert!(check_apart(&[file("in.png"), file(name)], [at("other.png")]).is_err(), "{name}");
    }
    let error = check_apart(&[file("new.png"), Destination::Stdout, file("sub/../new.png")], [at("in.png")]);
    assert!(error.unwrap_err().message.starts_with("is the same file as the output"));
    let apart = [file("new.png"), file("sub/new.png"), Destination::Stdout];
    assert_eq!(check_apart(&apart, [at("in.png"), at("missing/in.png")]), Ok(()));
    #[cfg(unix)]
    assert_eq!(check_apart(&["/dev/null", "/dev/null"].map(|name| Path::new(name).into()), ["/dev/null"]), Ok(()));
}
