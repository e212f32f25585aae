// SPDX-License-Identifier: MIT
/// What ends a run. Everything the library throws on purpose derives from Error; the message says
/// what failed, where, used and limit where one was hit, and what to try. Dirty geometry
/// (degenerate, non-finite, out of range) is not an error but a counter in Report, unless `strict`
/// is set.
#pragma once

#include <stdexcept>
#include <string>

namespace hewer {

class Error : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Options that contradict each other or leave their range. Thrown before any work.
class InvalidArgument : public Error {
  public:
    using Error::Error;
};

/// An input that is not what it claims to be: path and byte offset or line are in the message.
class FormatError : public Error {
  public:
    using Error::Error;
};

/// The operating system refused: path, operation and its reason are in the message.
class IoError : public Error {
  public:
    using Error::Error;
};

/// The memory limit is too small; the message names a sufficient one where it is known.
class OutOfMemoryBudget : public Error {
  public:
    using Error::Error;
};

/// The limit on temporary disk space was reached.
class OutOfDiskBudget : public Error {
  public:
    using Error::Error;
};

/// The caller's stop token asked for an end.
class Cancelled : public Error {
  public:
    Cancelled() : Error("cancelled") {}
};

/// A bug of ours: an invariant did not hold.
class InternalError : public Error {
  public:
    using Error::Error;
};

}  // namespace hewer
