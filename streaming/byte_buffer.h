// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>

namespace hewer::streaming {

/// Bytes to read into: grows, never shrinks, is never zeroed (vector::resize would be).
class ByteBuffer {
  public:
    /// At least `bytes` of room. What was there is lost when the buffer has to grow.
    unsigned char* room_for(std::size_t bytes) {
        if (bytes > capacity_) {
            capacity_ = 0;
            data_.reset(new unsigned char[bytes]);
            capacity_ = bytes;
        }
        return data_.get();
    }
    [[nodiscard]] const unsigned char* data() const { return data_.get(); }
    [[nodiscard]] std::size_t capacity() const { return capacity_; }

  private:
    std::unique_ptr<unsigned char[]> data_;
    std::size_t capacity_ = 0;
};

}  // namespace hewer::streaming
