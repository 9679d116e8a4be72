//! What a client asks for. Only two things can be read, and nothing can be written.

use std::net::{Ipv4Addr, Ipv6Addr};

/// Greatest size of a request in bytes. Those of browsers have less than one kilobyte.
pub(super) const GREATEST: usize = 8 << 10;
/// Greatest number of header fields.
const FIELDS: usize = 64;

/// What is asked for.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Asked {
    /// The request is not complete.
    Unfinished,
    /// The page; its head only, if a client asks so.
    Page { head: bool },
    /// The events.
    Events,
    /// Something else: the status line's end, and the reason for the reader.
    Refused(&'static str, &'static str),
}

const fn refused(status: &'static str, reason: &'static str) -> Asked {
    Asked::Refused(status, reason)
}

/// Reads a request. `name` is the name of this computer, if it has one.
///
/// A page from elsewhere in the same browser may ask for this address too, by a name that its owner points here
/// (DNS rebinding). Its name is in the request, so only addresses, `localhost` and `name` are answered.
pub(super) fn read(bytes: &[u8], name: Option<&str>) -> Asked {
    let mut fields = [httparse::EMPTY_HEADER; FIELDS];
    let mut request = httparse::Request::new(&mut fields);
    match request.parse(bytes) {
        Ok(httparse::Status::Complete(_)) => {}
        Ok(httparse::Status::Partial) if bytes.len() < GREATEST => return Asked::Unfinished,
        Ok(httparse::Status::Partial) | Err(httparse::Error::TooManyHeaders) => {
            return refused("431 Request Header Fields Too Large", "the request is too long");
        }
        Err(_) => return refused("400 Bad Request", "this is not a request by HTTP/1"),
    }
    let field = |name: &str| {
        let mut found =
            request.headers.iter().filter(|field| field.name.eq_ignore_ascii_case(name));
        found.next().map(|field| field.value)
    };
    let host = field("Host").and_then(|host| std::str::from_utf8(host).ok());
    if !host.is_some_and(|host| is_own(host, name)) {
        return refused(
            "421 Misdirected Request",
            "open the page by the address of this computer, such as http://127.0.0.1:8080/, or start the \
             program with the name: --serve NAME:PORT",
        );
    }
    let head = match request.method {
        Some("GET") => false,
        Some("HEAD") => true,
        _ => return refused("405 Method Not Allowed", "the page can only be read"),
    };
    let path = request.path.unwrap_or_default();
    match path.split('?').next() {
        Some("/") => Asked::Page { head },
        // Another page could not read the events, but it could use up the connections.
        Some("/events") if field("Sec-Fetch-Site") == Some(b"cross-site") => {
            refused("403 Forbidden", "the events are for the page of this program")
        }
        Some("/events") if !head => Asked::Events,
        _ => refused("404 Not Found", "there are only / and /events"),
    }
}

/// Whether a host, perhaps with a port, is an address, `localhost`, or the name of this computer.
fn is_own(host: &str, name: Option<&str>) -> bool {
    if let Some(rest) = host.strip_prefix('[') {
        return rest.split_once(']').is_some_and(|(number, _)| number.parse::<Ipv6Addr>().is_ok());
    }
    let bare = host.split(':').next().unwrap_or_default();
    bare.parse::<Ipv4Addr>().is_ok()
        || bare.eq_ignore_ascii_case("localhost")
        || name.is_some_and(|name| bare.eq_ignore_ascii_case(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ask(start: &str, fields: &str) -> Asked {
        read(format!("{start} HTTP/1.1\r\n{fields}\r\n").as_bytes(), Some("Truck.local"))
    }

    fn status(asked: &Asked) -> &'static str {
        match asked {
            Asked::Refused(status, _) => status.split(' ').next().unwrap(),
            _ => "200",
        }
    }

    #[test]
    fn two_things_can_be_read_and_nothing_written() {
        let own = "Host: 127.0.0.1:8080\r\n";
        assert_eq!(ask("GET /", own), Asked::Page { head: false });
        assert_eq!(ask("GET /?x=1", own), Asked::Page { head: false });
        assert_eq!(ask("HEAD /", own), Asked::Page { head: true });
        assert_eq!(ask("GET /events", own), Asked::Events);
        for (start, expected) in [
            ("POST /", "405"),
            ("PUT /events", "405"),
            ("DELETE /", "405"),
            ("OPTIONS *", "405"),
            ("CONNECT x:1", "405"),
            ("GET /favicon.ico", "404"),
            ("GET /../etc/passwd", "404"),
            ("GET //", "404"),
            ("HEAD /events", "404"),
        ] {
            assert_eq!(status(&ask(start, own)), expected, "{start}");
        }
    }

    #[test]
    fn only_addresses_and_own_names_are_answered() {
        for own in
            ["127.0.0.1", "192.168.1.7:8080", "[::1]:8080", "LOCALHOST:9", "truck.LOCAL:8080"]
        {
            assert_eq!(
                ask("GET /", &format!("Host: {own}\r\n")),
                Asked::Page { head: false },
                "{own}"
            );
        }
        for other in [
            "evil.example",
            "evil.example:8080",
            "127.0.0.1.evil.example",
            "[evil]:80",
            "",
            "localhost.evil",
        ] {
            let asked = ask("GET /events", &format!("Host: {other}\r\n"));
            assert_eq!(status(&asked), "421", "{other}");
        }
        assert_eq!(status(&ask("GET /", "")), "421");
    }

    #[test]
    fn events_are_not_for_other_pages() {
        let site =
            |site| ask("GET /events", &format!("Host: localhost\r\nSec-Fetch-Site: {site}\r\n"));
        assert_eq!(status(&site("cross-site")), "403");
        assert_eq!(site("same-origin"), Asked::Events);
    }

    #[test]
    fn a_request_has_a_greatest_size() {
        let long = format!("GET / HTTP/1.1\r\nHost: localhost\r\nX: {}", "x".repeat(GREATEST));
        assert_eq!(status(&read(long.as_bytes(), None)), "431");
        assert_eq!(read(&long.as_bytes()[..GREATEST - 1], None), Asked::Unfinished);
        assert_eq!(status(&ask("GET /", &"X: x\r\n".repeat(FIELDS + 1))), "431");
        assert_eq!(status(&read(b"\x16\x03\x01\x02\x00\x01", None)), "400"); // a browser that tries TLS
    }

    proptest! {
        /// Whatever arrives is answered or awaited, and only requests with an own host get something.
        #[test]
        fn no_bytes_are_fatal(bytes in prop::collection::vec(any::<u8>(), 0..200), cut in 0_usize..60) {
            let _ = read(&bytes, None);
            let mut request = b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n".to_vec();
            let place = cut.min(request.len() - 1);
            request.splice(place..=place, bytes.iter().copied());
            let _ = read(&request, None);
            prop_assert_eq!(read(&request[..place], None) == Asked::Events, false);
        }
    }
}
