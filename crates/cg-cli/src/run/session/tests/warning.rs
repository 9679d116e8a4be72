use super::*;

/// 0.25 g is above 0.5 times the threshold of 0.4 g.
#[test]
fn a_warning_follows_the_lateral_acceleration_or_the_yaw_rate() {
    let lateral_mps2 = 0.25 * design().gravity_mps2;
    for [lateral_mps2, yaw_rate_radps] in
        [[lateral_mps2, f64::NAN], [-lateral_mps2, 0.0], [f64::NAN, lateral_mps2 / 15.0]]
    {
        let mut session = session(None, 0.0);
        learn(&mut session, [Some(2.0), None]);
        let turn = Sample { lateral_acceleration_mps2: lateral_mps2, yaw_rate_radps, ..sample(0) };
        session.warn(&turn).unwrap();
        let [event] = &events(&mut session)[..] else { panic!("one event") };
        assert_eq!((&event["event"], &event["level"]), (&"warning".into(), &1.into()));
        let margin_g = event["margin_g"].as_f64().unwrap();
        assert!((margin_g - 0.15).abs() < 1e-6, "{margin_g}");
        let status = session.status();
        assert_eq!(status.warning_level, 1);
        assert!((status.margin_g.unwrap() - 0.15).abs() < 1e-6);
        assert!((status.lateral_acceleration_g.unwrap().abs() - 0.25).abs() < 1e-6);
    }
}

/// The bus goes silent in a turn: what was known of the turn is no longer known.
#[test]
fn a_warning_and_a_request_end_when_the_signals_do() {
    let mut session = session(None, 0.0);
    session.request = Some(SpeedRequest::new(0.5));
    learn(&mut session, [Some(2.0), None]);
    session.tick(0.0, 0);
    let lateral_acceleration_mps2 = 0.25 * design().gravity_mps2;
    session.push(Sample { lateral_acceleration_mps2, ..sample(0) }).unwrap();
    assert_eq!(names(&mut session), ["warning", "speed_request"]);
    for (now_us, ended) in [(SECOND_US, false), (SECOND_US + 1, true)] {
        session.tick(0.0, now_us);
        session.run_periodic(false).unwrap();
        let status = session.status();
        assert_eq!(
            (status.warning_level == 0, status.requested_speed_mps.is_none()),
            (ended, ended)
        );
        let expected: &[&str] = if ended { &["warning", "speed_request"] } else { &[] };
        assert_eq!(names(&mut session), expected);
    }
}

/// Nothing comes through a pipe in a turn. The rows that come late are used as if they had come in time.
#[test]
fn a_warning_and_a_request_end_while_a_stream_stalls() {
    let mut session = session(None, 1.0);
    session.request = Some(SpeedRequest::new(0.5));
    learn(&mut session, [Some(2.0), None]);
    session.driving = "turning";
    let lateral_acceleration_mps2 = 0.25 * design().gravity_mps2;
    let turning = |session: &mut Trial, now_us| {
        session.tick(0.0, now_us);
        session.push(Sample { lateral_acceleration_mps2, ..sample(now_us) }).unwrap();
        session.run_periodic(true).unwrap();
        names(session)
    };
    assert_eq!(turning(&mut session, 0), ["warning", "speed_request", "status"]);
    let stall = |session: &mut Trial, silence_ms| {
        let silence = std::time::Duration::from_millis(silence_ms);
        session.stall(silence, |_| vec![Signal::Speed.name()]).unwrap();
        let times: Vec<_> = events(session).iter().map(|event| event["time_s"].clone()).collect();
        assert!(times.iter().all(|time| time.as_f64() == Some(0.0)), "{times:?}");
        (times.len(), session.status())
    };
    assert_eq!(stall(&mut session, 1_000).0, 0);
    let (told, status) = stall(&mut session, 1_100);
    // The missing signal, the ends of both, that there are no signals, and the status.
    assert_eq!(told, 5);
    assert_eq!(
        (status.state, status.warning_level, status.requests_speed),
        ("no signals", 0, true)
    );
    assert!(status.requested_speed_mps.is_none());
    assert_eq!([stall(&mut session, 1_200).0, stall(&mut session, 9_000).0], [0, 1]);
    session.missing(Vec::new()).unwrap();
    names(&mut session);
    assert_eq!(turning(&mut session, 20_000), ["warning", "speed_request", "state", "status"]);
}

/// The present curve follows from the present speed, so the last one is not kept for a request.
#[test]
fn a_request_ends_when_the_speed_is_missing() {
    let mut session = session(None, 0.0);
    session.request = Some(SpeedRequest::new(0.5));
    learn(&mut session, [Some(2.0), None]);
    let lateral_acceleration_mps2 = 0.25 * design().gravity_mps2;
    let turning = |time_us| Sample { lateral_acceleration_mps2, ..sample(time_us) };
    session.push(turning(0)).unwrap();
    assert!(session.status().requested_speed_mps.is_some());
    session.missing(vec![Signal::Speed.name()]).unwrap();
    session.push(Sample { speed_mps: f64::NAN, ..turning(10_000) }).unwrap();
    let status = session.status();
    assert!(status.requested_speed_mps.is_none() && status.warning_level == 1);
}

#[test]
fn the_last_speed_is_kept() {
    let mut session = session(None, 0.0);
    session.warn(&sample(0)).unwrap();
    session.warn(&Sample { speed_mps: f64::NAN, ..sample(10_000) }).unwrap();
    assert!((session.speed_mps - 15.0).abs() < 1e-9);
}
