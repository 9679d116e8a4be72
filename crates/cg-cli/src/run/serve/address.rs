//! The address of the page: `--serve 8080`, `--serve 0.0.0.0:8080`, `--serve truck.local:8080`.

use std::io;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};
use std::str::FromStr;

/// An address and a port. A port alone is on the loopback interface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Address {
    host: Host,
    port: u16,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Host {
    Number(IpAddr),
    Name(String),
}

const FORMS: &str = "expected a port, such as 8080, which only this computer can open, or an address \
    and a port, such as 0.0.0.0:8080, which every computer in the network can open";

impl FromStr for Address {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Ok(port) = text.parse() {
            return Ok(Self { host: Host::Number(Ipv4Addr::LOCALHOST.into()), port });
        }
        if let Ok(socket) = text.parse::<SocketAddr>() {
            return Ok(Self { host: Host::Number(socket.ip()), port: socket.port() });
        }
        let allowed = |byte: u8| byte.is_ascii_alphanumeric() || b"-._".contains(&byte);
        match text.split_once(':').map(|(name, port)| (name, port.parse())) {
            Some((name, Ok(port)))
                if name.bytes().all(allowed)
                    && name.bytes().any(|byte| byte.is_ascii_alphabetic()) =>
            {
                Ok(Self { host: Host::Name(name.to_owned()), port })
            }
            _ => Err(FORMS.to_owned()),
        }
    }
}

impl Address {
    /// Opens the address.
    pub(super) fn listen(&self) -> anyhow::Result<TcpListener> {
        let opened = match &self.host {
            Host::Number(number) => TcpListener::bind((*number, self.port)),
            Host::Name(name) => TcpListener::bind((name.as_str(), self.port)),
        };
        opened.map_err(|error| {
            let advice = match error.kind() {
                io::ErrorKind::AddrInUse => "another program uses this port; give another one",
                io::ErrorKind::PermissionDenied => {
                    "ports below 1024 are reserved; give another one, such as 8080"
                }
                _ => "is it an address of this computer?",
            };
            anyhow::anyhow!("--serve {}:{}: {error}; {advice}", self.host(), self.port)
        })
    }

    /// The name of this computer, if the address is one. A browser may ask for the page by it.
    pub(super) fn name(&self) -> Option<&str> {
        match &self.host {
            Host::Name(name) => Some(name),
            Host::Number(_) => None,
        }
    }

    fn host(&self) -> String {
        match &self.host {
            Host::Name(name) => name.clone(),
            Host::Number(IpAddr::V6(number)) => format!("[{number}]"),
            Host::Number(number) => number.to_string(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_port_alone_is_on_the_loopback_interface() {
        for (text, host, name) in [
            ("8080", "127.0.0.1", None),
            ("0.0.0.0:8080", "0.0.0.0", None),
            ("[::1]:8080", "[::1]", None),
            ("truck.local:8080", "truck.local", Some("truck.local")),
        ] {
            let address: Address = text.parse().unwrap();
            assert_eq!((address.host().as_str(), address.name()), (host, name), "{text}");
            assert_eq!(address.port, 8080);
        }
    }

    #[test]
    fn what_is_not_an_address_is_refused() {
        for text in [
            "",
            "x",
            "localhost",
            "127.0.0.1",
            "1.2.3:80",
            "65536",
            "-1",
            "a:b",
            "::1:99999",
            "http://x:80",
            "a b:80",
            ":80",
        ] {
            assert_eq!(text.parse::<Address>(), Err(FORMS.to_owned()), "{text}");
        }
    }

    #[test]
    fn a_used_port_is_named() {
        let used = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = used.local_addr().unwrap().port();
        let address: Address = port.to_string().parse().unwrap();
        let message = address.listen().unwrap_err().to_string();
        assert!(message.starts_with(&format!("--serve 127.0.0.1:{port}: ")), "{message}");
        assert!(message.ends_with("another program uses this port; give another one"), "{message}");
    }
}
