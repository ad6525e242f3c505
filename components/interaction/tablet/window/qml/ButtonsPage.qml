import QtQuick
import Usher.Tablet

// Primary buttons in the middle: one or two large ones, or two columns.
Item {
    id: page

    required property double u
    required property ScreenModel model
    readonly property int count: model.primary.count
    readonly property bool few: count <= 2
    readonly property int columns: few ? Math.max(1, count) : 2
    readonly property int rows: Math.ceil(count / columns)
    readonly property double gap: 24 * u
    readonly property double cellWidth: few ? Math.min(820 * u, (width - gap * (columns - 1)) / columns)
                                            : (width - gap) / 2
    readonly property double cellHeight: Math.max(Theme.buttonHeight * u,
                                                  Math.min(few ? 380 * u : 250 * u,
                                                           (height - gap * (rows - 1)) / Math.max(1, rows)))

    Face {
        anchors.centerIn: parent
        visible: page.count === 0
        u: page.u
        awake: page.model.page !== ScreenModel.Away
        happy: page.model.state === "guide_success" || page.model.state === "end"
        height: Math.min(parent.height, 620 * page.u)
    }
    Grid {
        anchors.centerIn: parent
        columns: page.columns
        spacing: page.gap
        Repeater {
            model: page.model.primary
            BigButton {
                required property var model
                u: page.u
                buttonId: model.buttonId
                label: model.label
                kind: model.kind
                pending: model.pending
                active: model.active
                onPress: model.buttonId === "stop"
                width: page.cellWidth
                height: page.cellHeight
                textSize: (page.few ? 120 : Theme.buttonTextSize) * page.u
                onClicked: page.model.press(buttonId)
            }
        }
    }
}
