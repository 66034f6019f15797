// Standard output is a result: a disk that is full is an error, a reader that has seen enough (`| head`) is none.
#pragma once

namespace livecap::tools {

// A closed pipe fails the call that writes to it and ends nothing: a run outlives the reader of its progress.
void outlive_closed_pipes();

// False once something could not be written: nobody hears the rest.
bool is_heard();

// To be called last. Throws IoError when something was not written; ends the process quietly, as a closed pipe ends
// any other program, when the reader is gone.
void require_heard();

}  // namespace livecap::tools
