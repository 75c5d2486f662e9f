#include <Fulcrum/Constraints/Contacts/ContactBatch.h>

namespace fulcrum {

void ContactSolveSettings::Soften(float frequency, float dampingRatio, float h) {
    const float w = 6.28318531f * frequency;
    const float a = h * w * (2.0f * dampingRatio + h * w);
    pushRate = w / (2.0f * dampingRatio + h * w);
    massScale = a / (1.0f + a);
    impulseScale = 1.0f / (1.0f + a);
    constexpr float kSoftest = 0.125f;  // what is always left of the softness: it bounds the load of what can never come apart
    mostStiffer = (1 - kSoftest) * impulseScale;
    stiffening = impulseScale / maxPushSpeed;
}

}  // namespace fulcrum
