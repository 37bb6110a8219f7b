//! No bytes, however broken, make a reader panic; what it accepts is valid and can be written again.

use kineme_formats::tables::{angles, msr, positions};
use kineme_formats::vocabulary::VocabularyFile;
use kineme_formats::{
    FormatError, Place, manifest, marks, plan, profile, robot, script, vocabulary,
};
use proptest::prelude::*;

/// Feeds the bytes to every reader.
fn read_by_all(bytes: &[u8]) {
    let _ = positions::parse("a", bytes, None);
    let _ = msr::parse("a", bytes, None);
    let _ = marks::parse("a", bytes);
    let _ = profile::parse("a", bytes);
    let _ = manifest::parse("a", bytes);
    let _ = plan::parse("a", bytes);
    let alone = |file: &str| Err(FormatError::new(file, Place::File, "nothing", "a file"));
    let _ = robot::parse("a", bytes, &alone, None);
    if let Ok(table) = angles::parse("a", bytes) {
        let again = angles::parse("a", &table.write("a").unwrap()).unwrap();
        assert_eq!(again, table);
    }
    if let Ok(script) = script::parse("a", bytes) {
        script.validate().unwrap();
    }
    if let Ok(file) = VocabularyFile::parse("a", bytes) {
        let again = VocabularyFile::parse("a", &file.write("a").unwrap()).unwrap();
        assert_eq!(again, file);
    }
    let _ = vocabulary::read("a", bytes);
    let _ = (
        msr::sniff(bytes),
        positions::sniff(bytes),
        angles::sniff(bytes),
    );
}

/// One whole file of each kind.
fn whole_files() -> Vec<Vec<u8>> {
    let texts = [
        "frame,head_x,head_y,head_z,a_x,a_y,a_z\n0,1,2,3,4,5,6\n1,1,2,3,,,\n5,1,2,3,4,5,6\n",
        "time,root_x,root_y,root_z,root_yaw,a\n0,1,2,3,4,5\n0.5,,2,3,4,1e-9\n",
        "file,start,end,recording\na.bvh,0,1,r\n\"b,c\",0.5,1,\n",
        "file,label,start,end,rate,p1,p2\na.bvh,wave,0,1,120,0.5,1\n\"b,c\",,,,,,\n",
        "name = 'p'\nup = 'y'\nunit_metres = 0.01\n[roles]\nhips = 'H'\nhead = ['a', 'b']\n",
        "body = 'a'\n[[exemplar]]\nprimitive = 'p'\nparameters = { h = 1 }\n\
         keys = [{ time = 0 }, { time = 0.5, chest = [1, 2, 3] }]\n",
        "seconds = 1\n[[behavior]]\nprimitive = 'jab'\n[[rule]]\nwhen = 'a'\nthen = { primitive = 'b' }\n",
        "<mujoco><worldbody><body name='a'><body name='b' pos='0 0 1'><joint name='h' range='-9 9'/></body></body>\
         </worldbody></mujoco>",
        "<robot name='r'><link name='a'/><link name='b'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' \
         iyy='1' iyz='0' izz='1'/></inertial></link><joint name='h' type='revolute'><parent link='a'/><child link='b'/>\
         <origin xyz='0 0 1' rpy='1 0 0'/><limit lower='-1' upper='1' effort='9'/></joint></robot>",
    ];
    let mut files: Vec<Vec<u8>> = texts.iter().map(|t| t.as_bytes().to_vec()).collect();
    files.push("0.1 0.2 2.5 1.0\n".repeat(40).into_bytes());
    files.push(crate::vocabulary::example().write("v").unwrap());
    files
}

#[test]
fn deep_nesting_and_long_lines_are_refused() {
    const MANY: usize = 200_000;
    for text in [
        "<body>",
        "<default>",
        "<robot><link>",
        "<a b='",
        "[",
        "{a=",
        "a.",
        "(",
        ",",
        "\"",
        "0 ",
        "1e",
    ] {
        read_by_all(format!("body = {}", text.repeat(MANY)).as_bytes());
        read_by_all(text.repeat(MANY).as_bytes());
    }
    let header = "[".repeat(MANY);
    let container = [&(MANY as u64).to_le_bytes(), header.as_bytes()].concat();
    assert!(VocabularyFile::parse("a", &container).is_err());
}

/// Pieces that matter to one of the readers.
const PIECES: [&str; 16] = [
    "\"", ",", "\n", "\r\n", "_x", "nan", "1e308", "-", "0", "[", "{", "}", "= ", "'", "\u{feff}",
    "time",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        read_by_all(&bytes);
    }

    #[test]
    fn random_pieces_are_read_or_refused(picks in prop::collection::vec(0..PIECES.len(), 0..80)) {
        let text: String = picks.iter().map(|&i| PIECES[i]).collect();
        read_by_all(text.as_bytes());
    }

    #[test]
    fn mutations_are_read_or_refused(
        which in 0..9usize,
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4u8), 1..6),
    ) {
        let mut bytes = whole_files()[which].clone();
        for (index, byte, edit) in edits {
            if bytes.is_empty() {
                break;
            }
            let at = index.index(bytes.len());
            match edit {
                0 => bytes[at] = byte,
                1 => drop(bytes.remove(at)),
                2 => bytes.insert(at, byte),
                _ => bytes.truncate(at),
            }
        }
        read_by_all(&bytes);
    }
}
