#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

/// What capture programs send over the network, read from single datagrams. Nothing in a datagram is trusted.
namespace fascia::app {

/// A face as it was captured: values by name, `arkit:` before ARKit's. Names stay as the sender wrote them.
using CapturedValues = std::map<std::string, double>;

/// Adds the values of an OSC message or bundle of the VMC protocol (/VMC/Ext/Blend/Val NAME VALUE) and of
/// plain OSC
/// (/NAME VALUE, /face/NAME VALUE) to `values`. False when the datagram is not OSC or has no value.
bool read_osc(std::span<const uint8_t> datagram, CapturedValues& values);

/// Adds the values of a Live Link Face datagram (Epic Games' app, 61 numbers) to `values`. False when it is
/// none.
bool read_live_link(std::span<const uint8_t> datagram, CapturedValues& values);

}  // namespace fascia::app
