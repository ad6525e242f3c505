import QtQuick
import Usher.Tablet

// A line to type into with a keyboard, what was found beside it.
Item {
    id: page

    required property double u
    required property ScreenModel model
    readonly property double side: 936 * u
    property double below: 0

    Rectangle {
        id: line
        anchors.left: parent.left
        anchors.right: hits.left
        anchors.rightMargin: 20 * page.u
        anchors.top: parent.top
        height: 130 * page.u
        radius: 28 * page.u
        color: Theme.surface
        border.width: 6 * page.u
        border.color: Theme.focus
        Text {
            objectName: "typed"
            anchors.fill: parent
            anchors.leftMargin: 40 * page.u
            anchors.rightMargin: 40 * page.u
            verticalAlignment: Text.AlignVCenter
            text: page.model.typed + "▏"
            color: Theme.title
            font.pixelSize: Theme.buttonTextSize * page.u
            elide: Text.ElideLeft
            Accessible.role: Accessible.EditableText
            Accessible.name: page.model.queryLabel
        }
    }
    Keyboard {
        anchors.left: parent.left
        anchors.right: line.right
        anchors.top: line.bottom
        anchors.topMargin: 24 * page.u
        anchors.bottom: parent.bottom
        u: page.u
        onKey: letter => page.model.key(letter)
    }
    ButtonRow {
        id: hits
        anchors.right: parent.right
        anchors.top: parent.top
        width: page.side
        u: page.u
        buttons: page.model.primary
        stacked: true
        fill: page.side
        onPressed: buttonId => page.model.press(buttonId)
    }
}
