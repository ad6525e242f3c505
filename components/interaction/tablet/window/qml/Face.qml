import QtQuick
import Usher.Tablet

// MARVIN's face where there is nothing to choose.
Item {
    id: face

    required property double u
    property bool awake: true
    property bool happy: false

    width: height * 1.45
    Accessible.ignored: true

    Rectangle {
        anchors.fill: parent
        radius: height * 0.3
        color: Theme.surface
    }
    Rectangle {
        anchors.fill: parent
        anchors.margins: face.height * 0.11
        radius: height * 0.28
        color: Theme.background
    }
    Repeater {
        model: 2
        Rectangle {
            required property int index
            x: face.width * (index === 0 ? 0.31 : 0.69) - width / 2
            y: face.height * 0.44 - height / 2
            width: face.height * 0.2
            height: face.awake ? width : width * 0.2
            radius: height / 2
            color: face.awake ? Theme.yes : Theme.status
        }
    }
    Item {
        x: face.width * 0.5 - width / 2
        y: face.height * 0.66
        width: face.height * (face.happy ? 0.4 : 0.26)
        height: face.happy ? width * 0.32 : face.height * 0.035
        clip: true
        Rectangle {
            width: parent.width
            height: face.happy ? parent.width : parent.height
            y: face.happy ? parent.height - height : 0
            radius: height / 2
            color: face.happy ? "transparent" : (face.awake ? Theme.yes : Theme.status)
            border.width: face.happy ? face.height * 0.035 : 0
            border.color: Theme.yes
        }
    }
    // The smile's ends are round: on the middle of the ring, where it is cut.
    Repeater {
        model: face.happy ? 2 : 0
        Rectangle {
            required property int index
            x: face.width * 0.5 + (index === 0 ? -1 : 1) * face.height * 0.1677 - width / 2
            y: face.height * 0.66 - height / 2
            width: face.height * 0.035
            height: width
            radius: width / 2
            color: Theme.yes
        }
    }
}
