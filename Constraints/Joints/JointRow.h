// The rows of a joint in one step, besides its locks: limits in reach, active motors, springs and friction. Filled once
// a step by the types (JointType.h), solved in lanes (JointBatch.h). Plain data, no threads.
//
// A row is one equation between two bodies A and B: dC/dt = J v.
#pragma once

#include <Fulcrum/Constraints/Parts/RowJacobian.h>
#include <Fulcrum/Constraints/Parts/SpringSettings.h>

#include <limits>
#include <new>
#include <type_traits>

namespace fulcrum {

struct JointRow {
    enum class Kind : uint8_t {
        Equal,          // C = 0
        AtLeast,        // C >= 0: can increase C, never reduce it
        Spring,         // C = 0, soft as given by `spring`
        SpringAtLeast,  // the same, active if C < 0
        Speed,          // J v = speed: motors, and friction with speed 0
    };
    static constexpr float kUnlimited = std::numeric_limits<float>::infinity();

    Kind kind = Kind::Equal;
    uint8_t slot =
        0;  // identifies the row among those of its type: its impulse of the last step is stored by this number
    RowJacobian<float>
        jacobian;             // of an axis, angle, gear, rack-and-pinion or independent-axis part (Constraints/Parts)
    float error = 0;          // C at the start of the step, m or rad
    float speed = 0;          // m/s or rad/s
    bool turnsWithA = false;  // J rotates with A from substep to substep; else it is constant
    bool about = false;       // C is an angle, although it may depend on positions, too; set by SetAbout
    bool radial = false;      // acts along the line from A's anchor to B's and rotates with it
    // J of an angle may also rotate with both bodies: about a direction of A across one of B, or halfway between them.
    enum class Pivot : uint8_t { None, Across, Between };
    Pivot pivot = Pivot::None;
    Vector3 ofA = Vector3::Zero(), ofB = Vector3::Zero();  // unit, world: those directions
    bool isLock = false;     // Equal rows, the first of the list, that are solved as one block
    bool inRadians = false;  // C is in rad, although the row moves anchors; else as J says
    bool isStopped = false;  // a motor without a target speed, or that a limit stops: it drives nothing
    float minForce = -kUnlimited, maxForce = kUnlimited;  // N or N m
    SpringSettings spring;
};

// The rows of one joint in one step. Only added rows are initialized: a list is made for every joint with rows in every
// step, and clearing its whole capacity took ten times as long as most joints need to fill it.
struct JointRowList {
    static constexpr uint32_t kMaxRows = 24;   // six axes, each with two limits, a motor and friction
    static constexpr uint32_t kMostLocks = 5;  // rows with isLock

    class Rows {
    public:
        Rows() {}
        JointRow& operator[](size_t i) { return rows_[i]; }
        const JointRow& operator[](size_t i) const { return rows_[i]; }

    private:
        union {
            JointRow rows_[kMaxRows];
        };
    };
    Rows rows;
    uint32_t count = 0;

    // Adds a row in the slot, to be filled by the caller.
    JointRow& Add(uint32_t slot, JointRow::Kind kind) {
        FULCRUM_ASSERT(count < kMaxRows && slot < kMaxRows);
        JointRow& row = *new (&rows[count++]) JointRow();
        row.slot = static_cast<uint8_t>(slot);
        row.kind = kind;
        return row;
    }
};
static_assert(std::is_trivially_destructible_v<JointRow>);

}  // namespace fulcrum
