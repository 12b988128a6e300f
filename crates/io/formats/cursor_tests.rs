//! Tests of the cursor over a file's text and bytes.

use super::*;

fn cursor(folder: &tempfile::TempDir, bytes: &[u8]) -> Cursor {
    let path = folder.path().join("a");
    std::fs::write(&path, bytes).unwrap();
    Cursor::new(&Source::open(&path).unwrap())
}

#[test]
fn words_and_lines_cross_windows() {
    let folder = tempfile::tempdir().unwrap();
    let count = WINDOW / 4;
    let text: String = (0..count).map(|i| format!("{i}\r\n")).collect();
    let mut words = cursor(&folder, text.as_bytes());
    let mut lines = cursor(&folder, text.as_bytes());
    for i in 0..count {
        assert_eq!(words.number::<u64>(NumberType::I64, "a number").unwrap(), i as u64);
        assert_eq!(lines.line().unwrap().unwrap(), i.to_string().as_bytes());
        assert_eq!(lines.line_number(), i + 2);
    }
    assert!(words.word().unwrap().is_none() && lines.line().unwrap().is_none());
    assert_eq!((words.left(), lines.left()), (0, 0));
}

#[test]
fn damaged_numbers_are_named_in_tables() {
    let folder = tempfile::tempdir().unwrap();
    let text = "1 2 3 4\n".repeat(50) + "5 x 7\n";
    let whole = cursor(&folder, text.as_bytes()).numbers::<u64>(NumberType::U64, 201, "a tag");
    assert_eq!(whole.unwrap().len(), 201);
    for count in [203, 300] {
        let mut table = cursor(&folder, text.as_bytes());
        let error = table.numbers::<u64>(NumberType::U64, count, "a tag").unwrap_err();
        assert_eq!(error.location.line_column, Some((51, 1)), "{error}");
        assert!(error.to_string().contains("'x'") && error.to_string().contains("a tag"), "{error}");
    }
    let mut short = cursor(&folder, &text.as_bytes()[..400]);
    let error = short.numbers::<u64>(NumberType::U64, 300, "a tag").unwrap_err().to_string();
    assert!(error.contains("ends early"), "{error}");
    let mut bytes = vec![0; 800];
    bytes[403] = 0xff;
    let mut table = cursor(&folder, &bytes);
    table.binary = Some(ByteOrder::Little);
    let error = table.numbers::<u32>(NumberType::I32, 200, "a tag").unwrap_err();
    assert!(error.to_string().contains("byte 404"), "{error}");
}

#[test]
fn a_word_is_passed_over_where_it_is_the_one() {
    let folder = tempfile::tempdir().unwrap();
    for before in [0, 7, WINDOW - 9, WINDOW - 1, WINDOW] {
        let text = format!("{}\n\nofFsets\n Offsets2 OFFSETS", "x".repeat(before));
        let mut cursor = cursor(&folder, text.as_bytes());
        cursor.until(is_space).unwrap();
        for other in ["OFFSET", "OFFSETS2", "x"] {
            assert!(!cursor.word_if(other).unwrap(), "{other} {before}");
            assert_eq!((cursor.position(), cursor.line_number()), (before as u64, 1), "{before}");
        }
        assert!(cursor.word_if("OFFSETS").unwrap(), "{before}");
        assert_eq!((cursor.last_line(), cursor.left()), (3, 18), "{before}");
        assert!(!cursor.word_if("OFFSETS").unwrap() && cursor.word_if("offsets2").unwrap());
        assert!(cursor.word_if("OFFSETS").unwrap() && !cursor.word_if("OFFSETS").unwrap(), "{before}");
        assert_eq!((cursor.line_number(), cursor.left()), (4, 0), "{before}");
    }
}

#[test]
fn a_clone_is_at_the_same_place_without_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let mut cursor = cursor(&folder, b"one two\nthree");
    cursor.word().unwrap();
    let mut copy = cursor.clone();
    assert_eq!((copy.window.capacity(), copy.position(), copy.left()), (0, 3, 10));
    for _ in 0..2 {
        assert_eq!(copy.word().unwrap().map(<[u8]>::to_vec), cursor.word().unwrap().map(<[u8]>::to_vec));
        assert_eq!((copy.last_line(), copy.line_number()), (cursor.last_line(), cursor.line_number()));
    }
    assert_eq!(copy.last_line(), 2);
}

#[test]
fn a_mark_is_found_across_windows_and_bytes_are_skipped() {
    let folder = tempfile::tempdir().unwrap();
    for shift in 0..6 {
        let text = format!("{}$$End\nx", "-\n".repeat(WINDOW / 2 - 3) + &"-".repeat(shift));
        let mut cursor = cursor(&folder, text.as_bytes());
        assert_eq!(cursor.skip_past(b"$End").unwrap(), Some((WINDOW - 5 + shift) as u64));
        assert_eq!(cursor.line_number(), WINDOW / 2 - 2);
        assert_eq!(cursor.bytes(2).unwrap(), b"\nx");
        assert!(cursor.bytes(1).is_err() && cursor.skip_past(b"$End").unwrap().is_none());
    }
    let mut long = cursor(&folder, &[b'a'; 3 * WINDOW]);
    long.skip(2 * WINDOW as u64 + 1).unwrap();
    assert_eq!((long.left(), long.bytes(3).unwrap().len()), (WINDOW as u64 - 1, 3));
    let short = long.skip(WINDOW as u64).unwrap_err().to_string();
    assert!(short.contains("found 262140 bytes; expected 262144 bytes"), "{short}");
}
