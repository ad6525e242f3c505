import QtQuick
import Usher.Tablet

// A panel of buttons side by side, or one below the other.
Grid {
    id: row

    required property double u
    required property ButtonsModel buttons
    property bool stacked: false
    property double fill: 0 // width of stacked buttons
    property double buttonHeight: Theme.buttonHeight * u
    property double textSize: Theme.buttonTextSize * u

    signal pressed(string buttonId)

    columns: stacked ? 1 : Math.max(1, buttons.count)
    spacing: 24 * u

    Repeater {
        model: row.buttons
        BigButton {
            required property var model
            u: row.u
            buttonId: model.buttonId
            label: model.label
            kind: model.kind
            pending: model.pending
            active: model.active
            onPress: model.buttonId === "stop"
            textSize: row.textSize
            width: row.stacked ? row.fill : wanted
            height: row.buttonHeight
            onClicked: row.pressed(buttonId)
        }
    }
}
