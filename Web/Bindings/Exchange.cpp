#include <Fulcrum/Web/Bindings/Exchange.h>

namespace fulcrum::web {

Exchange& Shared() {
    static Exchange shared;
    return shared;
}

int Fail(const Error& error) {
    Shared().answer = error.message;
    return 0;
}

int Answer(const Json& json) {
    Shared().answer = json.dump();
    return 1;
}

int Outcome(const Status& status) { return status ? 1 : Fail(status.GetError()); }

void PutId(uint32_t index, uint32_t generation) {
    Shared().numbers[0] = index;
    Shared().numbers[1] = generation;
}

// A buffer for `size` bytes of input.
FULCRUM_FOR_JAVASCRIPT char* fulcrum_input(size_t size) {
    Shared().input.resize(size);
    return Shared().input.data();
}
FULCRUM_FOR_JAVASCRIPT const char* fulcrum_answer() { return Shared().answer.data(); }
FULCRUM_FOR_JAVASCRIPT size_t fulcrum_answerSize() { return Shared().answer.size(); }
FULCRUM_FOR_JAVASCRIPT double* fulcrum_numbers() { return Shared().numbers.data(); }

}  // namespace fulcrum::web
