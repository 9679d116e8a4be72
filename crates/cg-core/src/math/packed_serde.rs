//! A packed triangle as a sequence of its numbers. (Derived code has arrays of at most 32.)

use core::fmt;
use core::marker::PhantomData;

use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeTuple;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::math::linalg::Packed;
use crate::math::real::Real;

impl<T: Serialize, const N: usize, const P: usize> Serialize for Packed<T, N, P> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut tuple = serializer.serialize_tuple(P)?;
        self.0.iter().try_for_each(|value| tuple.serialize_element(value))?;
        tuple.end()
    }
}

impl<'de, T: Real + Deserialize<'de>, const N: usize, const P: usize> Deserialize<'de>
    for Packed<T, N, P>
{
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_tuple(P, Numbers(PhantomData))
    }
}

struct Numbers<T, const N: usize, const P: usize>(PhantomData<T>);

impl<'de, T: Real + Deserialize<'de>, const N: usize, const P: usize> Visitor<'de>
    for Numbers<T, N, P>
{
    type Value = Packed<T, N, P>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{P} numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
        let mut values = [T::ZERO; P];
        for (place, value) in values.iter_mut().enumerate() {
            *value = sequence.next_element()?.ok_or_else(|| Error::invalid_length(place, &self))?;
        }
        Ok(Packed(values))
    }
}
