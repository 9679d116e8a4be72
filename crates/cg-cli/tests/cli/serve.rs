//! `cg run --serve` over real connections. The page itself is tested in Chromium, with the Python package.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::common::{Run, cg, command, fixture, kraz};

/// A program that serves. It ends with the test.
struct Served {
    child: Child,
    out: BufReader<std::process::ChildStdout>,
    address: String,
    start: String,
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Runs the independent truck from this log.
fn serve(log: &str, more: &[&str]) -> Served {
    let truck = kraz();
    let mut arguments = vec!["run", "--vehicle", &truck, "--csv", log, "--serve", "0"];
    arguments.extend(more);
    let piped = |command: &mut Command| {
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let mut child = piped(&mut command(&arguments));
    let mut out = BufReader::new(child.stdout.take().unwrap());
    let mut start = String::new();
    out.read_line(&mut start).unwrap();
    let line: Value = serde_json::from_str(&start).unwrap();
    let page = line["page"].as_str().unwrap();
    let address = page.strip_prefix("http://").unwrap().trim_end_matches('/').to_owned();
    assert!(address.starts_with("127.0.0.1:"), "{address}");
    Served { child, out, address, start }
}

impl Served {
    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        stream
    }

    fn ask(&self, request: &str) -> TcpStream {
        let mut stream = self.connect();
        stream.write_all(request.as_bytes()).unwrap();
        stream
    }

    /// The whole answer to a request with this first line and host.
    fn answer(&self, line: &str, host: &str) -> String {
        let mut text = String::new();
        let mut stream = self.ask(&format!("{line} HTTP/1.1\r\nHost: {host}\r\n\r\n"));
        stream.read_to_string(&mut text).unwrap();
        text
    }

    fn events(&self) -> impl Iterator<Item = (String, Value)> + use<> {
        let stream = self.ask("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
        let mut name = "message".to_owned();
        BufReader::new(stream).lines().map_while(Result::ok).filter_map(move |line| {
            if let Some(named) = line.strip_prefix("event: ") {
                named.clone_into(&mut name);
            }
            let data = serde_json::from_str(line.strip_prefix("data: ")?).unwrap();
            Some((std::mem::replace(&mut name, "message".to_owned()), data))
        })
    }

    /// The lines up to the end of the log.
    fn rest(&mut self) -> Vec<Value> {
        let mut lines = vec![serde_json::from_str(&self.start).unwrap()];
        while lines.last().is_none_or(|line: &Value| line["event"] != "stop") {
            let mut text = String::new();
            assert!(self.out.read_line(&mut text).unwrap() > 0, "no stop");
            lines.push(serde_json::from_str(&text).unwrap());
        }
        lines
    }

    fn ask_to_stop(&mut self) -> Run {
        let kill = Command::new("kill").args(["-15", &self.child.id().to_string()]).status();
        assert!(kill.unwrap().success());
        let code = self.child.wait().unwrap().code();
        let mut run = Run { code, out: String::new(), err: String::new() };
        self.child.stderr.take().unwrap().read_to_string(&mut run.err).unwrap();
        run
    }
}

/// The history is made of lines of the output, the snapshot is the last status, and the points of the last maneuver lie
/// on the line of the model: the independent truck's roll angle per lateral acceleration is within the 95 % interval.
#[test]
fn the_events_are_those_of_the_output() {
    let mut served = serve(&fixture("logs/A_p20_h190_v50_L.csv"), &[]);
    let lines = served.rest();
    let mut events = served.events();
    let (name, history) = events.next().unwrap();
    assert_eq!(name, "history");
    let history = history.as_array().unwrap();
    assert!(history.iter().all(|line| lines.contains(line)));
    for (event, kept) in [("start", 1), ("maneuver", 1), ("status", 1), ("stop", 1), ("notice", 1)]
    {
        assert_eq!(history.iter().filter(|line| line["event"] == event).count(), kept, "{event}");
    }
    let (name, turn) = events.next().unwrap();
    assert_eq!(name, "turn");
    let (name, snapshot) = events.next().unwrap();
    assert_eq!(name, "snapshot");
    assert_eq!(Some(&snapshot), lines.iter().rfind(|line| line["event"] == "status"));
    assert_eq!(snapshot["present"][0], "steer");

    let numbers = |key: &str| -> Vec<f64> {
        turn[key].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
    };
    let (input, roll) = (numbers("lateral_acceleration_mps2"), numbers("roll_rad"));
    assert!(input.len() == roll.len() && input.len() > 50, "{}", input.len());
    let products = |other: &[f64]| input.iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
    // This log has no offset.
    let slope = products(&roll) / products(&input);
    let [low, high] = numbers("ratio_ci95")[..] else { panic!("{turn}") };
    assert!(low < slope && slope < high, "{slope}: {low} to {high}");
    assert!(served.ask_to_stop().done().err.is_empty());
}

#[test]
fn nothing_can_be_written_and_other_names_get_nothing() {
    let served = serve("-", &[]);
    let page = served.answer("GET /", "localhost");
    assert!(page.starts_with("HTTP/1.1 200 OK\r\n") && page.ends_with("</html>\n"));
    assert!(page.contains("Content-Security-Policy: default-src 'none';"));
    let head = served.answer("HEAD /", "localhost");
    assert!(page.starts_with(&head) && head.ends_with("\r\n\r\n"));
    for (line, host, status) in [
        ("POST /", "localhost", "405"),
        ("GET /etc/passwd", "localhost", "404"),
        ("GET /events", "evil.example", "421"),
        ("GET", "localhost", "400"),
    ] {
        let answer = served.answer(line, host);
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{line}: {answer}");
        assert!(!answer.contains("kraz"));
    }
}

/// Feeds a log and returns the lines up to the end.
fn fed(served: &mut Served, log: &str, mut pipe: ChildStdin) -> Vec<Value> {
    let text = std::fs::read(log).unwrap();
    std::thread::scope(|scope| {
        scope.spawn(move || pipe.write_all(&text).unwrap());
        served.rest()
    })
}

/// Thirty clients that never read, ten that send half a request, and one that reads: the output is the same as without
/// them, and the one that reads gets the events.
#[test]
fn clients_change_nothing() {
    let log = fixture("logs/A_p20_h190_v50_L.csv");
    let alone = cg(&["run", "--vehicle", &kraz(), "--csv", &log]).done().json();
    let mut served = serve("-", &[]);
    let ask = "GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n";
    let mut reader = served.events();
    assert_eq!(reader.next().unwrap().0, "history");
    let silent: Vec<TcpStream> = (0..30).map(|_| served.ask(ask)).collect();
    let half: Vec<TcpStream> = (0..10).map(|_| served.ask("GET /ev")).collect();
    let pipe = served.child.stdin.take().unwrap();
    let with = fed(&mut served, &log, pipe);
    // Only the source and the address of the page differ.
    assert_eq!(with[1..], alone[1..]);
    let got: Vec<Value> =
        reader.filter(|(name, _)| name == "message").map(|(_, line)| line).collect();
    assert_eq!(got, alone[1..], "the connection ends with the program");
    // Reading at last, the others find the same events; those beyond the limit were refused.
    let texts = silent.into_iter().map(|mut stream| {
        let mut text = String::new();
        let _ = stream.read_to_string(&mut text);
        text
    });
    let (listened, refused): (Vec<_>, Vec<_>) =
        texts.partition(|text| text.starts_with("HTTP/1.1 200"));
    assert!(listened.iter().all(|text| text.contains("\"event\":\"stop\"")));
    assert!(refused.iter().all(|text| text.starts_with("HTTP/1.1 503")));
    assert_eq!((listened.len(), refused.len()), (23, 7));
    drop(half);
}

/// A client that never reads does not keep the program from ending.
#[test]
fn a_stalled_client_does_not_hold_up_the_end() {
    let mut served = serve(&fixture("logs/A_p20_h190_v50_L.csv"), &[]);
    let _silent = served.ask("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    let _mute = served.connect();
    served.rest();
    let began = Instant::now();
    served.ask_to_stop().done();
    // Half a second for the last events, and some turns of the server.
    assert!(began.elapsed() < Duration::from_secs(5), "{:?}", began.elapsed());
}

#[test]
fn an_address_that_cannot_be_used_is_refused() {
    let (truck, log) = (kraz(), fixture("logs/A_p20_h190_v50_L.csv"));
    let run = |address: &str| cg(&["run", "--vehicle", &truck, "--csv", &log, "--serve", address]);
    run("localhost").refused(&[
        "'--serve <ADDR>'",
        "expected a port, such as 8080",
        "0.0.0.0:8080",
    ]);
    let served = serve("-", &[]);
    run(&served.address).refused(&["--serve 127.0.0.1:", "another program uses this port"]);
    run("192.0.2.1:8080")
        .refused(&["--serve 192.0.2.1:8080: ", "is it an address of this computer?"]);
}
