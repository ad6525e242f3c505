import QtQuick
import Usher.Tablet

// A button of the thesis, section 7.2.1: at least 45 x 22 mm, its color by what it means.
FocusScope {
    id: button

    required property double u
    property string buttonId
    property string label
    property int kind: 0
    property bool pending: false
    // Dim: it takes no touch yet.
    property bool active: true
    property double textSize: Theme.buttonTextSize * u
    // A stop must not wait for the finger to leave.
    property bool onPress: false
    // Who chose the wrong language, or none, finds the way back without reading.
    readonly property bool signed: buttonId === "languages"
    readonly property double signRoom: signed ? globe.width + 18 * u : 0
    readonly property double wanted: Math.max(Theme.buttonWidth * u, caption.implicitWidth + signRoom + 72 * u)
    readonly property bool cut: caption.truncated
    readonly property bool down: area.pressed || pending

    signal clicked()

    objectName: "button:" + buttonId
    implicitWidth: wanted
    implicitHeight: Theme.buttonHeight * u
    activeFocusOnTab: true
    Accessible.role: Accessible.Button
    Accessible.name: label
    Accessible.onPressAction: button.clicked()
    Keys.onReturnPressed: button.clicked()
    Keys.onSpacePressed: button.clicked()

    Rectangle {
        anchors.fill: parent
        opacity: button.active ? 1 : 0.4
        radius: 28 * button.u
        color: button.down ? Qt.lighter(Theme.button(button.kind), 1.18) : Theme.button(button.kind)
        border.width: button.activeFocus || button.pending ? 8 * button.u : 0
        border.color: Theme.focus
        scale: button.down ? 0.97 : 1
    }
    GlobeItem {
        id: globe
        objectName: "globe"
        visible: button.signed
        x: (parent.width - caption.implicitWidth - button.signRoom) / 2
        anchors.verticalCenter: parent.verticalCenter
        width: 84 * button.u
        height: width
        color: caption.color
    }
    Text {
        id: caption
        anchors.centerIn: parent
        anchors.horizontalCenterOffset: button.signRoom / 2
        width: parent.width - button.signRoom - 24 * button.u
        horizontalAlignment: Text.AlignHCenter
        text: button.label
        color: button.active ? Theme.ink : Theme.title
        font.pixelSize: button.textSize
        font.weight: Font.DemiBold
        elide: Text.ElideRight
        Accessible.ignored: true
    }
    MouseArea {
        id: area
        anchors.fill: parent
        onPressed: if (button.onPress)
            button.clicked()
        onClicked: if (!button.onPress)
            button.clicked()
    }
}
