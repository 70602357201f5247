//! Files that LibreOffice 7.4 has written: a sheet of 121 rows, with the German locale and without the reading in row 18,
//! converted by `soffice --headless --convert-to 'csv:Text - txt - csv (StarCalc):…,1031,…'` with the charsets UTF-8, UTF-16
//! and Latin-1.

use kalmanscope_core::import::{Builder, Decimal, Delimiter, Encoding, Imported, Mapping, read};
use kalmanscope_core::{Hold, InputKind, Quantity};

/// The file, its encoding and its delimiter.
const FILES: [(&[u8], Encoding, Delimiter); 3] = [
    (include_bytes!("data/libreoffice/german.csv"), Encoding::Utf8, Delimiter::Semicolon),
    (include_bytes!("data/libreoffice/utf-16.csv"), Encoding::Utf16Le, Delimiter::Semicolon),
    (include_bytes!("data/libreoffice/latin-1-tabs.csv"), Encoding::Latin1, Delimiter::Tab),
];

#[test]
fn files_of_a_german_libreoffice_are_read_without_a_choice() {
    for (bytes, encoding, delimiter) in FILES {
        let table = read(bytes, None).unwrap();
        let dialect = table.dialect;
        assert_eq!((dialect.encoding, dialect.delimiter, dialect.decimal), (encoding, delimiter, Decimal::Comma));
        let (mapping, kind) = Mapping::guess(&table);
        assert_eq!(kind, InputKind::Force);
        let Imported { record, remarks, .. } =
            Builder::new(&table, &mapping, kind, Hold::First).unwrap().finish().unwrap();
        assert_eq!(remarks, Vec::<String>::new());
        assert_eq!((record.len(), record.dt()), (121, 0.05));
        assert_eq!((record.input()[1], record.input()[120]), (0.005, 0.0));
        let displacement = record.measured_quantity(Quantity::DISPLACEMENT).unwrap();
        assert!((displacement[1] - 1.9098e-3).abs() < 1e-15, "{}", displacement[1]);
        let missing: Vec<usize> = (0..121).filter(|&k| displacement[k].is_nan()).collect();
        assert_eq!(missing, [17]);
    }
}
