//! URIs: percent signs and data in the URI itself (RFC 3986, RFC 2397).

use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

/// The usual alphabet; padding may be missing, as some exporters leave it out.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// Bytes of a data URI without its leading `data:`.
pub(super) fn decode_data(data: &str) -> Result<Vec<u8>, String> {
    let Some((head, body)) = data.split_once(',') else {
        return Err("a data URI needs a comma before its data".to_owned());
    };
    let is_base64 = head.rsplit(';').next().is_some_and(|last| last.trim().eq_ignore_ascii_case("base64"));
    if !is_base64 {
        return Ok(percent_bytes(body));
    }
    BASE64.decode(body).map_err(|error| format!("the data URI is not base64: {error}"))
}

/// `uri` with `%20` and the like replaced by what they stand for; unchanged where that is not UTF-8.
pub(super) fn decode_percent(uri: &str) -> String {
    String::from_utf8(percent_bytes(uri)).unwrap_or_else(|_| uri.to_owned())
}

fn percent_bytes(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while i < bytes.len() {
        let escaped = (bytes[i] == b'%').then(|| hex_pair(bytes.get(i + 1..i + 3)?)).flatten();
        out.push(escaped.unwrap_or(bytes[i]));
        i += if escaped.is_some() { 3 } else { 1 };
    }
    out
}

fn hex_pair(digits: &[u8]) -> Option<u8> {
    let value = |d: u8| char::from(d).to_digit(16);
    Some((value(digits[0])? * 16 + value(digits[1])?) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_escapes_are_undone_and_broken_ones_stay() {
        assert_eq!(decode_percent("a%20b%C3%A9.png"), "a bé.png");
        assert_eq!(decode_percent("100%.png"), "100%.png");
        assert_eq!(decode_percent("%zz%2"), "%zz%2");
        assert_eq!(decode_percent("%FF"), "%FF", "not UTF-8");
    }

    #[test]
    fn data_comes_in_base64_and_in_escapes() {
        assert_eq!(decode_data("application/octet-stream;base64,AQID"), Ok(vec![1, 2, 3]));
        assert_eq!(decode_data(";base64,AQI="), Ok(vec![1, 2]));
        assert_eq!(decode_data(";base64,AQI"), Ok(vec![1, 2]), "without padding");
        assert_eq!(decode_data(",a%00b"), Ok(vec![b'a', 0, b'b']));
        assert!(decode_data("no comma").is_err());
        assert!(decode_data(";base64,!!!").expect_err("not base64").contains("base64"));
    }
}
