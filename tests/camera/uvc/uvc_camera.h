#pragma once
// The simulated camera's firmware: answers control requests and streams frames over one bulk endpoint, with the faults
// that are asked for.
#include <deque>
#include <fstream>
#include <string>

#include "tests/camera/uvc/descriptors.h"
#include "tests/camera/uvc/sensor.h"
#include "tests/camera/uvc/usbip.h"

namespace hdr::sim {

struct Faults {
  bool no_manual_exposure = false;
  bool exposure_refused = false;  ///< setting the exposure time stalls: "not ready"
  bool exposure_silent = false;   ///< setting it is never answered: the kernel gives up after 5 s
  int damaged_every = 0;          ///< every n-th frame is cut in half and has the error bit; 0: none
  int lost_every = 0;             ///< every n-th frame comes without data
  int unplug_at_frame = -1;
  int freeze_at_frame = -1;  ///< it stays plugged in, and no frame comes any more
};

class UvcCamera {
 public:
  /// log: one line a frame: stream, frame, exposure in 100 us, gain in 1/16; empty: none.
  UvcCamera(const SensorOptions& sensor, const Faults& faults, const std::string& log);

  /// Serves the host for about `seconds`. False when the cable is out.
  bool serve(double seconds);
  void unplug() { usb_.detach(); }

 private:
  struct Answer {
    int status = 0;
    Bytes data;
    bool silent = false;
  };
  void handle(const UsbRequest& request);
  Answer control(const UsbRequest& request);
  Answer standard_request(const UsbRequest& request);
  Answer streaming_request(const UsbRequest& request);
  Answer unit_request(const UsbRequest& request);
  Answer set_unit(int entity, int selector, const Bytes& data);

  void stream(double now);
  bool frozen() const { return frame_number_ == faults_.freeze_at_frame; }
  void take_frame(double now);
  void send_frame();
  void stop_streaming();

  UsbIpDevice usb_;
  Sensor sensor_;
  Faults faults_;
  std::ofstream log_;

  std::deque<UsbRequest> waiting_;  ///< bulk requests that the host has open
  std::deque<UsbRequest> unanswered_;
  std::uint8_t format_ = 1, frame_ = 1;
  std::uint32_t interval_ = kIntervals[0];
  std::uint8_t last_error_ = 0;

  bool streaming_ = false;
  double next_frame_at_ = 0;
  int frame_number_ = 0, stream_number_ = 0;
  Bytes payload_;         ///< header and picture of the frame that is being sent
  std::size_t sent_ = 0;  ///< bytes of it
  std::uint8_t frame_id_ = 0;
};

}  // namespace hdr::sim
